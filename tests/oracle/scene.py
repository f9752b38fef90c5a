"""A compiled scene in float64: what lies at a point of a triangle, and rays that try every triangle."""

from __future__ import annotations

from typing import Any

import numpy as np

from pylmc.colour import LUMINANCE
from pylmc.sampling.compiled import CompiledScene

from .materials import side_by_side
from .vectors import Array, dot, norm


class World:
    """A compiled scene in float64. ``evenness``: the target's weights on a grid over the film, ones unless given.

    ``aim``: from where paths are aimed at targets, as in Settings.
    """

    def __init__(self, compiled: CompiledScene, evenness: Array | None = None, aim: str = "everywhere") -> None:
        self.evenness, self.aim = evenness, aim
        self.arrays, self.features = compiled.arrays, compiled.features
        a = compiled.arrays
        self.corners = a["vertices"].astype(float)[a["faces"]]
        edges = self.corners[:, 1:] - self.corners[:, :1]
        self.areas = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=-1) / 2
        self.normals = a["triangles"]["normal"].astype(float)
        self.corner_normals = a["normals"].astype(float)[a["faces"]] if len(a["normals"]) else np.zeros((0, 3, 3))
        self.uvs = a["uvs"].astype(float)[a["faces"]] if len(a["uvs"]) else np.zeros((0, 3, 2))
        self.materials = side_by_side(a["materials"], a["lobes"])[a["triangles"]["material"]]
        self.camera = a["camera"][0]
        self.origin = self.camera["origin"].astype(float)
        # segments within this of a surface that they leave or meet count for nothing (vectors.cl)
        self.ray_offset = 4e-15 if compiled.features["BVH_DOUBLE"] else 2e-6
        self._light_the_triangles()

    def _light_the_triangles(self) -> None:
        """Radiance of each triangle, and the density per area with which points of emitters are drawn.

        A shape is drawn half by its power and half as likely as any other, a point of it uniformly.
        """
        emitter = self.arrays["triangles"]["emitter"]
        radiance = self.arrays["emitters"]["radiance"].reshape(-1, 3).astype(float)
        self.radiance = np.vstack([radiance, np.zeros((1, 3))])[emitter]
        shining = emitter >= 0
        area = np.bincount(emitter[shining], weights=self.areas[shining], minlength=len(radiance))
        power = area * (radiance @ LUMINANCE)
        if not len(radiance):
            self.emitter_density = np.zeros(len(emitter))
            return
        share = (power / power.sum() + 1 / len(radiance)) / 2
        self.emitter_density = np.append(share / area, 0.0)[emitter]

    def weights(self, triangle: Array, x: Array) -> Array:
        """Barycentric weights (…, 3) of the points x in their triangles' planes, inside or not."""
        p = self.corners[triangle]
        e1, e2, d = p[..., 1, :] - p[..., 0, :], p[..., 2, :] - p[..., 0, :], x - p[..., 0, :]
        a, b, c, f, g = dot(e1, e1), dot(e1, e2), dot(e2, e2), dot(d, e1), dot(d, e2)
        u, v = (f * c - g * b) / (a * c - b * b), (g * a - f * b) / (a * c - b * b)
        return np.stack([1 - u - v, u, v], axis=-1)

    def shading_normal(self, triangle: Array, x: Array) -> Array:
        """The interpolated normal where the mesh is smooth, on the geometric normal's side."""
        ng = self.normals[triangle]
        if not len(self.corner_normals):
            return ng
        blended = np.einsum("...k,...ki->...i", self.weights(triangle, x), self.corner_normals[triangle])
        size = norm(blended)[..., None]
        smooth = (self.arrays["triangles"]["smooth"][triangle] != 0)[..., None] & (size > 0)
        ns = np.where(smooth, blended / np.maximum(size, 1e-300), ng)
        return ns * np.where(dot(ns, ng) < 0, -1, 1)[..., None]

    def texture(self, triangle: Array, x: Array) -> Array:
        """The texture's bilinear value, or white. Complex steps do not see its slope."""
        tint = np.ones((*triangle.shape, 3))
        chosen = self.materials["texture"][triangle]
        for index in np.unique(chosen[chosen >= 0]):
            info = self.arrays["textures"][index]
            h, w = int(info["height"]), int(info["width"])
            image = self.arrays["texels"][info["offset"] : info["offset"] + h * w].reshape(h, w, 3).astype(float)
            here = chosen == index
            uv = np.einsum("nk,nki->ni", self.weights(triangle[here], x[here].real), self.uvs[triangle[here]])
            column, row = uv[:, 0] * w - 0.5, (1 - uv[:, 1]) * h - 0.5  # row 0 is the image's top
            c, r = np.floor(column).astype(int), np.floor(row).astype(int)
            fc, fr = (column - c)[:, None], (row - r)[:, None]
            tint[here] = sum(
                wc * wr * image[(r + j) % h, (c + i) % w]
                for i, wc in ((0, 1 - fc), (1, fc))
                for j, wr in ((0, 1 - fr), (1, fr))
            )
        return tint

    def cast(self, origins: Array, directions: Array, skip: Array | None = None) -> tuple[Array, Array]:
        """(t, triangle) of the closest by trying all; infinity, -1 on a miss. ``skip``: triangles that rays leave."""
        p0 = self.corners[:, 0]
        e1, e2 = self.corners[:, 1] - p0, self.corners[:, 2] - p0
        best, which = np.full(len(origins), np.inf), np.full(len(origins), -1)
        for k, (o, d) in enumerate(zip(origins, directions, strict=True)):
            p = np.cross(d, e2)
            with np.errstate(all="ignore"):
                inverse = 1 / dot(e1, p)
                s = o - p0
                u = dot(s, p) * inverse
                q = np.cross(s, e1)
                v, t = (q @ d) * inverse, dot(e2, q) * inverse
                ok = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 1e-9)
            if skip is not None and skip[k] >= 0:
                ok[skip[k]] = False
            if ok.any():
                which[k] = np.flatnonzero(ok)[np.argmin(t[ok])]
                best[k] = t[which[k]]
        return best, which

    def crossing(self, portal: Any, x: Array, v: Array, t: Array) -> tuple[Array, Array]:
        """(does the segment pass this portal, where its line meets the plane)."""
        centre, normal, axis = (portal[name].astype(float) for name in ("centre", "normal", "axis"))
        with np.errstate(all="ignore"):
            at = ((centre - x) @ normal) / (v @ normal)
            point = x + at[:, None] * v
            offset = point - centre
            through = (at > 0) & (at < t) & (np.abs(offset @ axis) <= portal["half_size"][0])
            through &= np.abs(offset @ np.cross(normal, axis)) <= portal["half_size"][1]
        return through, point
