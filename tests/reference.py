"""A plain float64 reference of the path model: lobes, integrand, independent density, charts, constraints.

Written from theory.md and the papers, and not from the kernels: microfacet terms are angles and tangents here,
densities are products over splits of area densities, and tangents are central differences of whole displaced paths.
Everything is batched over paths of one length and ending; node index i runs from 0 (camera) to K as in theory.md.

Only conventions are shared with the kernels, since a matrix cannot be compared without them: the order of coordinates,
the first frame (:func:`any_tangent`), and the widths and axes that constraints.cl documents.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.ndimage import map_coordinates

from pylmc.compiled import CompiledScene
from pylmc.device_scene import SCENE_ARGUMENTS
from pylmc.preconditioner import combine
from pylmc.sampler import Sampler

LUMINANCE = np.array([0.212671, 0.715160, 0.072169])
DIFFUSE, REFLECT, DIELECTRIC_REFLECT, TRANSMIT = range(4)
CONNECT, HIT = range(2)
PROJECTION, DEVIATION, NODE, APERTURE = range(4)
AIM_MARGIN = 1.002  # apertures are aimed at with this margin, and 1e-6 scene radii
AIM_FROM_LIGHT, AIM_FROM_NODE, AIM_FROM_CAMERA = 0.5, 0.25, 0.1

Array = np.ndarray


# --- vectors -------------------------------------------------------------------------------------------------------


def dot(a: Array, b: Array) -> Array:
    """Inner products over the last axis."""
    return np.einsum("...i,...i->...", a, b)


def unit(a: Array) -> Array:
    """Normalised."""
    return a / np.maximum(np.linalg.norm(a, axis=-1, keepdims=True), 1e-300)


def mirror(v: Array, n: Array) -> Array:
    """v reflected about the plane across n."""
    return v - 2 * dot(v, n)[..., None] * n


def turn_minimally(u: Array, a: Array, b: Array) -> Array:
    """u turned by the rotation about a × b that takes a to b (Rodrigues' formula; any u, not only one across a)."""
    axis, cosine = np.cross(a, b), dot(a, b)[..., None]
    return cosine * u + np.cross(axis, u) + axis * dot(axis, u)[..., None] / (1 + cosine)


def any_tangent(n: Array) -> Array:
    """The kernels' convention for a tangent of n (Duff et al. 2017)."""
    s = np.copysign(1.0, n[..., 2])
    a = -1 / (s + n[..., 2])
    return np.stack([1 + s * n[..., 0] ** 2 * a, s * n[..., 0] * n[..., 1] * a, -s * n[..., 0]], axis=-1)


# --- microfacets ---------------------------------------------------------------------------------------------------


def ggx_d(cosine: Array, alpha: Array) -> Array:
    """GGX distribution in the angle θ of the microfacet normal: α² / (π cos⁴θ (α² + tan²θ)²)."""
    c2 = np.clip(cosine, 1e-150, 1) ** 2
    tan2 = (1 - c2) / c2
    return np.where(cosine > 0, alpha**2 / (np.pi * c2**2 * (alpha**2 + tan2) ** 2), 0.0)


def ggx_d_at(m: Array, n: Array, alpha: Array) -> Array:
    """The same from vectors; tan θ as a ratio of lengths, exact for the narrowest lobes."""
    c = dot(m, n)
    tan2 = dot(np.cross(m, n), np.cross(m, n)) / np.maximum(c**2, 1e-300)
    return np.where(c > 0, alpha**2 / (np.pi * c**4 * (alpha**2 + tan2) ** 2), 0.0)


def smith_lambda(w: Array, n: Array, alpha: Array) -> Array:
    """Smith's Λ of GGX."""
    tan2 = dot(np.cross(w, n), np.cross(w, n)) / dot(w, n) ** 2
    return (np.sqrt(1 + alpha**2 * tan2) - 1) / 2


def shadowing(wi: Array, wo: Array, n: Array, alpha: Array, separable: Array) -> Array:
    """G2, height-correlated or the product of both G1."""
    i, o = smith_lambda(wi, n, alpha), smith_lambda(wo, n, alpha)
    return np.where(separable, 1 / (1 + i) / (1 + o), 1 / (1 + i + o))


def fresnel(cosine: Array, eta: Array) -> Array:
    """Unpolarised reflectance from the angles of incidence and refraction (Snell); eta: far index over near."""
    sine_t = np.sqrt(np.maximum(1 - cosine**2, 0)) / eta
    inside = sine_t < 1
    ct = np.sqrt(np.maximum(1 - np.minimum(sine_t, 1) ** 2, 0))
    with np.errstate(invalid="ignore"):  # 0 / 0 in the surface itself
        rs = (cosine - eta * ct) / (cosine + eta * ct)
        rp = (ct - eta * cosine) / (ct + eta * cosine)
    return np.where(inside, (rs**2 + rp**2) / 2, 1.0)


@dataclass(frozen=True)
class Surface:
    """Nodes' local properties, batched: geometric and shading normal, texture colour, material record, lobe."""

    x: Array
    ng: Array
    ns: Array
    tint: Array
    material: Array
    lobe: Array

    def index_ratio(self, w: Array) -> Array:
        """Index of the far side over that of w's side."""
        ior = np.where(self.material["ior"] > 0, self.material["ior"], 1.0).astype(float)
        return np.where(dot(self.ns, w) > 0, ior, 1 / ior)


def half_vectors(s: Surface, wi: Array, wo: Array) -> tuple[Array, Array, Array]:
    """(n on w_i's side, microfacet normal on n's side, eta of the refraction or one)."""
    n = np.where(dot(s.ns, wi)[:, None] > 0, s.ns, -s.ns)
    eta = np.where(s.lobe == TRANSMIT, s.index_ratio(wi), 1.0)
    m = wi + eta[:, None] * wo
    m = m / np.maximum(np.linalg.norm(m, axis=-1, keepdims=True), 1e-300)
    return n, m * np.where(dot(m, n) < 0, -1, 1)[:, None], eta


def lobe_value(s: Surface, wi: Array, wo: Array) -> Array:
    """f |cos θ_o| of each surface's own lobe as RGB, radiance convention (camera's side w_i)."""
    n, m, eta = half_vectors(s, wi, wo)
    alpha = np.maximum(s.material["alpha"].astype(float), 1e-9)
    ci, co, im, om = dot(n, wi), dot(n, wo), dot(m, wi), dot(m, wo)
    agree_i = dot(s.ns, wi) * dot(s.ng, wi) > 0
    same = agree_i & (dot(s.ng, wi) * dot(s.ng, wo) > 0) & (co > 0)
    opposite = agree_i & (dot(s.ng, wi) * dot(s.ng, wo) < 0) & (co < 0) & (im > 0) & (om < 0)
    with np.errstate(all="ignore"):
        micro = ggx_d_at(m, n, alpha) * shadowing(wi, wo, n, alpha, s.material["separable"] != 0)
        reflection = micro / (4 * ci)
        # Walter et al. (21) times cos θ_o, over the η² by which radiance is compressed
        refraction = (1 - fresnel(im, eta)) * micro * np.abs(im * om) / (ci * (im + eta * om) ** 2)
        f0 = s.material["specular"] + s.material["specular_tinted"] * s.tint
        schlick = f0 + (1 - f0) * ((1 - np.clip(np.abs(im), 0, 1)) ** 5)[:, None]
        coloured = np.where(s.material["schlick"][:, None] != 0, schlick, f0)
        both = fresnel(im, s.index_ratio(wi))[:, None] * np.ones(3)
    out = np.zeros((len(wi), 3))
    for lobe, mask, value in (
        (DIFFUSE, same, (co / np.pi)[:, None] * s.material["diffuse"] * s.tint),
        (REFLECT, same, reflection[:, None] * coloured),
        (DIELECTRIC_REFLECT, same, reflection[:, None] * both),
        (TRANSMIT, opposite, refraction[:, None] * np.ones(3)),
    ):
        use = mask & (s.lobe == lobe)
        out[use] = value[use]
    return out


def lobe_density(s: Surface, known: Array, other: Array) -> Array:
    """Density per solid angle of the lobe's own sampling (no aiming): cosine, or visible normals (Heitz 2018)."""
    n, m, eta = half_vectors(s, known, other)
    alpha = np.maximum(s.material["alpha"].astype(float), 1e-9)
    ci, co, im, om = dot(n, known), dot(n, other), dot(m, known), dot(m, other)
    with np.errstate(all="ignore"):
        visible = ggx_d_at(m, n, alpha) / (1 + smith_lambda(known, n, alpha)) * np.maximum(im, 0) / ci
        reflected = visible / (4 * np.abs(om))
        refracted = visible * eta**2 * np.abs(om) / (im + eta * om) ** 2 * (1 - fresnel(im, eta))
        shared = fresnel(im, s.index_ratio(known))
        reflected_share = reflected * shared
    sides = (dot(s.ns, known) * dot(s.ns, other) > 0) & (dot(s.ng, known) * dot(s.ng, other) > 0)
    out = np.zeros(len(known))
    for lobe, mask, value in (
        (DIFFUSE, sides, np.abs(dot(s.ns, other)) / np.pi),
        (REFLECT, (co > 0) & (ci > 0), reflected),
        (DIELECTRIC_REFLECT, (co > 0) & (ci > 0), reflected_share),
        (TRANSMIT, (co < 0) & (im > 0) & (om < 0), refracted),
    ):
        use = mask & (s.lobe == lobe)
        out[use] = value[use]
    return out


# --- the scene and its paths ---------------------------------------------------------------------------------------


def film_weight_at(evenness: Array, positions: Array) -> Array:
    """The target's weight at film positions (n, 2), x first: linear between the centres of the grid's cells."""
    size = len(evenness)
    at = np.clip(positions.T[::-1] * size - 0.5, 0, size - 1.001)  # short of the last centre, as in the kernel
    return map_coordinates(evenness.astype(float), at, order=1, mode="nearest")


@dataclass(frozen=True)
class Paths:
    """Paths of one length K and ending. Arrays are (n, K+1, …), node 0 the camera; v, t: the arriving segment."""

    length: int
    ending: int
    light: Array
    triangle: Array
    lobe: Array
    x: Array
    v: Array
    t: Array
    ng: Array
    ns: Array
    tint: Array

    @property
    def free(self) -> int:
        """How many directions are free."""
        return self.length - (self.ending == CONNECT)

    def take(self, which: Any) -> Paths:
        """A part of the paths."""
        fields = ("light", "triangle", "lobe", "x", "v", "t", "ng", "ns", "tint")
        return replace(self, **{name: getattr(self, name)[which] for name in fields})


class World:
    """A compiled scene in float64. ``evenness``: the target's weights on a grid over the film, ones unless given."""

    def __init__(self, compiled: CompiledScene, evenness: Array | None = None) -> None:
        self.evenness = evenness
        self.arrays, self.features = compiled.arrays, compiled.features
        a = compiled.arrays
        self.corners = a["vertices"].astype(float)[a["faces"]]
        edges = self.corners[:, 1:] - self.corners[:, :1]
        self.areas = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=-1) / 2
        self.normals = a["triangles"]["normal"].astype(float)
        self.corner_normals = a["normals"].astype(float)[a["faces"]] if len(a["normals"]) else np.zeros((0, 3, 3))
        self.uvs = a["uvs"].astype(float)[a["faces"]] if len(a["uvs"]) else np.zeros((0, 3, 2))
        self.materials = a["materials"][a["triangles"]["material"]]
        self.camera = a["camera"][0]
        self.origin = self.camera["origin"].astype(float)
        emitter = a["triangles"]["emitter"]
        radiance = np.vstack([a["emitters"]["radiance"].reshape(-1, 3), np.zeros((1, 3))])[emitter].astype(float)
        self.radiance = radiance
        power = self.areas * (radiance @ LUMINANCE)
        # drawn in proportion to area times luminance, uniformly on the triangle
        self.emitter_density = (radiance @ LUMINANCE) / max(power.sum(), 1e-300)

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
        size = np.linalg.norm(blended, axis=-1, keepdims=True)
        smooth = (self.arrays["triangles"]["smooth"][triangle] != 0)[..., None] & (size > 0)
        ns = np.where(smooth, blended / np.maximum(size, 1e-300), ng)
        return ns * np.where(dot(ns, ng) < 0, -1, 1)[..., None]

    def texture(self, triangle: Array, x: Array) -> Array:
        """The texture's bilinear value, or white."""
        tint = np.ones((*triangle.shape, 3))
        chosen = self.materials["texture"][triangle]
        for index in np.unique(chosen[chosen >= 0]):
            info = self.arrays["textures"][index]
            h, w = int(info["height"]), int(info["width"])
            image = self.arrays["texels"][info["offset"] : info["offset"] + h * w].reshape(h, w, 3).astype(float)
            here = chosen == index
            uv = np.einsum("nk,nki->ni", self.weights(triangle[here], x[here]), self.uvs[triangle[here]])
            column, row = uv[:, 0] * w - 0.5, (1 - uv[:, 1]) * h - 0.5  # row 0 is the image's top
            c, r = np.floor(column).astype(int), np.floor(row).astype(int)
            fc, fr = (column - c)[:, None], (row - r)[:, None]
            tint[here] = sum(wc * wr * image[(r + j) % h, (c + i) % w]
                             for i, wc in ((0, 1 - fc), (1, fc)) for j, wr in ((0, 1 - fr), (1, fr)))  # fmt: skip
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

    def paths(self, length: int, ending: int, light: Array, triangle: Array, weights: Array, lobe: Array) -> Paths:
        """Paths through the given points (barycentric ``weights``) of ``triangle`` (n, K); -1: the light itself."""
        n = len(light)
        x = np.zeros((n, length + 1, 3))
        x[:, 0] = self.origin
        on = np.maximum(triangle, 0)
        x[:, 1:] = np.einsum("njk,njki->nji", weights, self.corners[on])
        if ending == CONNECT:
            x[:, -1] = self.arrays["points"]["position"].astype(float)[light]
        full = np.concatenate([np.full((n, 1), -1), triangle], axis=1)
        lobes = np.concatenate([np.full((n, 1), -1), lobe], axis=1)
        return self.complete(length, ending, light, full, lobes, x)

    def complete(self, length: int, ending: int, light: Array, triangle: Array, lobe: Array, x: Array) -> Paths:
        """All that follows from the nodes."""
        on = np.maximum(triangle, 0)
        ng = np.where((triangle >= 0)[..., None], self.normals[on], 0)
        ns = np.where((triangle >= 0)[..., None], self.shading_normal(on, x), 0)
        tint = np.where((triangle >= 0)[..., None], self.texture(on, x), 1)
        t, v = np.zeros(x.shape[:2]), np.zeros_like(x)
        steps = np.diff(x, axis=1)
        t[:, 1:] = np.linalg.norm(steps, axis=-1)
        v[:, 1:] = steps / t[:, 1:, None]
        return Paths(length, ending, light, triangle, lobe, x, v, t, ng, ns, tint)

    def surface(self, paths: Paths, i: int) -> Surface:
        """Node i as a scatterer."""
        material = self.materials[np.maximum(paths.triangle[:, i], 0)]
        return Surface(paths.x[:, i], paths.ng[:, i], paths.ns[:, i], paths.tint[:, i], material, paths.lobe[:, i])

    # --- integrand and independent density

    def importance(self, v: Array) -> Array:
        """The camera's W, zero off the film."""
        c = self.camera
        depth = v @ c["forward"].astype(float)
        with np.errstate(all="ignore"):
            across = np.stack([v @ c["right"].astype(float) / c["tan_x"], v @ c["up"].astype(float) / c["tan_y"]])
            inside = (depth > 0) & np.all(np.abs(across / depth) < 1, axis=0)
            return np.where(inside, 1 / (4.0 * c["tan_x"] * c["tan_y"] * depth**3), 0.0)

    def radiance_of(self, paths: Paths) -> Array:
        """C of theory.md, 1, as RGB (visibility not looked at)."""
        c = self.importance(paths.v[:, 1])[:, None] * np.ones(3)
        for i in range(1, paths.length):
            c = c * lobe_value(self.surface(paths, i), -paths.v[:, i], paths.v[:, i + 1])
        if paths.ending == CONNECT:
            return c * self.arrays["points"]["intensity"].astype(float)[paths.light] / paths.t[:, -1:] ** 2
        front = dot(paths.ng[:, -1], paths.v[:, -1]) < 0
        return c * np.where(front[:, None], self.radiance[paths.triangle[:, -1]], 0)

    def log_pi(self, paths: Paths) -> Array:
        """log I: luminance, times the weight of the film position."""
        with np.errstate(divide="ignore"):
            return np.log(self.radiance_of(paths) @ LUMINANCE * self.film_weight(paths.v[:, 1]))

    def film_weight(self, v: Array) -> Array:
        """The evenness of directions' film positions."""
        if self.evenness is None:
            return np.ones(len(v))
        c = self.camera
        with np.errstate(all="ignore"):
            depth = v @ c["forward"].astype(float)
            across = np.stack([v @ c["right"].astype(float) / c["tan_x"], -(v @ c["up"].astype(float)) / c["tan_y"]])
            position = np.nan_to_num((across / depth + 1) / 2)
        return film_weight_at(self.evenness, position.T)

    def aimed(self, x: Array, direction: Array, otherwise: Array, share: float) -> Array:
        """Density of a direction aimed at one of the targets with probability ``share``."""
        targets = self.arrays["targets"]
        if not len(targets):
            return otherwise
        total = np.zeros(len(x))
        for target in targets:
            centre = target["centre"].astype(float)
            if target["sphere"]:
                to = centre - x
                distance = np.linalg.norm(to, axis=-1)
                sine2 = np.minimum((float(target["half_size"][0]) / distance) ** 2, 1)
                apart = np.linalg.norm(direction - to / distance[:, None], axis=-1) ** 2 / 2  # 1 - cos
                fall = sine2 / (1 + np.sqrt(1 - sine2))
                inside = distance <= target["half_size"][0]
                total += np.where(inside, 1 / (4 * np.pi), np.where(apart <= fall, 1 / (2 * np.pi * fall), 0))
                continue
            normal, axis = target["normal"].astype(float), target["axis"].astype(float)
            cosine = direction @ normal
            with np.errstate(all="ignore"):
                t = ((centre - x) @ normal) / cosine
                offset = x + t[:, None] * direction - centre
                half = AIM_MARGIN * target["half_size"].astype(np.float64) + 1e-6
                inside = (t > 0) & (np.abs(offset @ axis) <= half[0])
                inside &= np.abs(offset @ np.cross(normal, axis)) <= half[1]
                area = 4.0 * half[0] * half[1]
                total += np.where(inside, t**2 / (area * np.abs(cosine)), 0)
        return (1 - share) * otherwise + share * total / len(targets)

    def scatter_density(self, paths: Paths, i: int, known: Array, other: Array) -> Array:
        """Density of drawing ``other`` at node i, aiming included."""
        s = self.surface(paths, i)
        plain = lobe_density(s, known, other)
        return np.where(s.lobe == DIFFUSE, self.aimed(s.x, other, plain, AIM_FROM_NODE), plain)

    def log_p(self, paths: Paths) -> Array:
        """log p_ind: the mean over the splits of area densities, turned into solid angle at the end."""
        k_all = paths.length
        n = len(paths.light)
        cosine = [np.ones(n)] + [np.abs(dot(paths.ng[:, i], paths.v[:, i])) for i in range(1, k_all + 1)]
        to_area = [np.ones(n)] + [cosine[i] / paths.t[:, i] ** 2 for i in range(1, k_all + 1)]
        first = self.aimed(paths.x[:, 0], paths.v[:, 1], self.importance(paths.v[:, 1]), AIM_FROM_CAMERA)
        camera: list[Array] = [np.ones(n), first * to_area[1]]
        for i in range(2, k_all + 1):
            camera.append(self.scatter_density(paths, i - 1, -paths.v[:, i - 1], paths.v[:, i]) * to_area[i])
        light: list[Array] = [np.ones(n)] * (k_all + 1)
        out = -paths.v[:, k_all]
        if paths.ending == HIT:
            light[k_all] = self.emitter_density[paths.triangle[:, k_all]]
            plain = np.maximum(dot(paths.ng[:, k_all], out), 0) / np.pi
        else:
            chance = np.diff(self.arrays["points"]["cumulative"].astype(float), prepend=0)
            light[k_all], plain = chance[paths.light], np.full(n, 1 / (4 * np.pi))
        for j in range(k_all - 1, 0, -1):
            away = -paths.v[:, j + 1]
            if j == k_all - 1:
                density = self.aimed(paths.x[:, k_all], away, plain, AIM_FROM_LIGHT)
            else:
                density = self.scatter_density(paths, j + 1, paths.v[:, j + 2], away)
            light[j] = density * np.abs(dot(paths.ng[:, j], away)) / paths.t[:, j + 1] ** 2
        splits = range(k_all + 1 if paths.ending == HIT else k_all)
        with np.errstate(divide="ignore", invalid="ignore"):
            # x_1 … x_k from the camera, the rest from the light
            logs = [np.log(np.stack(camera[1 : k + 1] + light[k + 1 :])).sum(axis=0) for k in splits]
            log_sum = np.logaddexp.reduce(np.stack(logs), axis=0)
            log_sum -= np.log(len(splits))
            for i in range(1, paths.free + 1):
                log_sum -= np.log(to_area[i])
            for i in range(1, k_all):
                s = self.surface(paths, i)
                chance = s.material["choose_diffuse"].astype(float)
                log_sum += np.log(np.where(s.lobe == DIFFUSE, chance, 1 - chance))
        return log_sum

    def narrow(self, paths: Paths, i: int) -> Array:
        """Whether node i takes part as a near-mirror."""
        s = self.surface(paths, i)
        return (s.lobe != DIFFUSE) & (s.material["narrow"] != 0)

    def crossing(self, aperture: Any, x: Array, v: Array, t: Array) -> tuple[Array, Array]:
        """(does the segment pass this aperture, where its line meets the plane)."""
        centre, normal, axis = (aperture[name].astype(float) for name in ("centre", "normal", "axis"))
        with np.errstate(all="ignore"):
            at = ((centre - x) @ normal) / (v @ normal)
            point = x + at[:, None] * v
            offset = point - centre
            through = (at > 0) & (at < t) & (np.abs(offset @ axis) <= aperture["half_size"][0])
            through &= np.abs(offset @ np.cross(normal, axis)) <= aperture["half_size"][1]
        return through, point


def world_of(sampler: Sampler) -> World:
    """The sampler's scene, with the weights over the film that its start has chosen."""
    device = sampler.device_scene
    initial = sampler.compiled.arrays["evenness"]
    buffer = device.buffers[list(SCENE_ARGUMENTS).index("evenness")]
    return World(sampler.compiled, device.read(buffer, initial.dtype, initial.shape))


def read_paths(sampler: Sampler, world: World) -> dict[tuple[int, int], tuple[Array, Paths]]:
    """The chains' paths by (length, ending): which chains, and the paths made again from triangles and barycentrics."""
    device = sampler.device_scene
    raw = device.read(sampler._states, device.dtypes["ChainState"], sampler.chains)
    out = {}
    for length, ending in sorted({(int(k), int(e)) for k, e in zip(raw["length"], raw["ending"], strict=True)}):
        which = np.flatnonzero((raw["length"] == length) & (raw["ending"] == ending))
        vertex = raw["vertex"][which][:, :length]
        u, v = vertex["bu"].astype(float), vertex["bv"].astype(float)
        weights = np.stack([1 - u - v, u, v], axis=-1)
        paths = world.paths(length, ending, raw["light"][which], vertex["triangle"], weights, vertex["lobe"])
        out[length, ending] = which, paths
    return out


def write_paths(sampler: Sampler, paths: Paths, weights: Array) -> None:
    """Make these paths (with the barycentric ``weights`` that they were made from) the chains' states."""
    device = sampler.device_scene
    n = len(paths.light)
    raw = np.zeros(n, device.dtypes["ChainState"])
    raw["length"], raw["ending"], raw["light"] = paths.length, paths.ending, paths.light
    vertex = raw["vertex"]
    for i in range(1, paths.length + 1):
        vertex["v"][:, i - 1], vertex["t"][:, i - 1] = paths.v[:, i], paths.t[:, i]
        vertex["bu"][:, i - 1], vertex["bv"][:, i - 1] = weights[:, i - 1, 1], weights[:, i - 1, 2]
        vertex["triangle"][:, i - 1], vertex["lobe"][:, i - 1] = paths.triangle[:, i], paths.lobe[:, i]
    sampler._states = device.upload(raw)
    sampler.chains = n


# --- charts and displaced paths ------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Moved:
    """A displaced path: its nodes and what the constraints look at; log dσ/dδ summed over the charts."""

    paths: Paths
    s: list[Array]
    log_jacobian: Array


class Charts:
    """The coordinates of the first m directions of paths whose charts are of the same kinds (n paths at once).

    ``chart``: equal-area or orthographic (the unit variant has the latter's map). Paths move on the planes of their own
    triangles, so that differences never fall off an edge.
    """

    def __init__(self, world: World, paths: Paths, m: int, target: bool, chart: str, p: Array) -> None:
        self.world, self.base, self.m, self.target, self.chart = world, paths, m, target, chart
        self.p = unit(p - dot(p, paths.v[:, 1])[:, None] * paths.v[:, 1])
        n = len(paths.light)
        self.kinds = np.zeros((n, m + 1), int)
        self.anchor, self.e1, self.e2, self.normal = (np.zeros((n, m + 1, 3)) for _ in range(4))
        self.omega = np.zeros((n, m + 1, 2))
        frame = self.p
        for j in range(1, m + 1):
            v = paths.v[:, j]
            s, frame = self.arrive(paths, j, frame) if j > 1 else (v, frame)
            self.kinds[:, j], crossing, aperture = self.kind(j)
            q = np.cross(s, frame)
            self.anchor[:, j], self.e1[:, j], self.e2[:, j] = s, frame, q
            across = np.stack([dot(v, frame), dot(v, q)], axis=-1)
            if chart == "equal-area":
                across = across / np.sqrt((1 + dot(s, v)) / 2)[:, None]
            self.omega[:, j] = np.where((self.kinds[:, j] == DEVIATION)[:, None], across, 0)
            node = self.kinds[:, j] == NODE
            self.anchor[node, j], self.normal[node, j] = paths.x[node, j], paths.ng[node, j]
            self.e1[node, j] = any_tangent(paths.ng[node, j])
            self.e2[node, j] = np.cross(paths.ng[node, j], self.e1[node, j])
            for k in np.unique(aperture[aperture >= 0]):
                use = aperture == k
                record = world.arrays["apertures"][k]
                self.anchor[use, j], self.normal[use, j] = crossing[use], record["normal"]
                self.e1[use, j] = record["axis"]
                self.e2[use, j] = np.cross(record["normal"].astype(float), record["axis"].astype(float))
            if j > 1:
                frame = turn_minimally(frame, s, v)

    def kind(self, j: int) -> tuple[Array, Array, Array]:
        """(kind, crossing point, aperture or -1) of direction j, from theory.md, 2."""
        n = len(self.base.light)
        crossing, aperture = np.zeros((n, 3)), np.full(n, -1)
        if not self.target:
            return np.full(n, PROJECTION if j == 1 else DEVIATION), crossing, aperture
        for k in range(len(self.world.arrays["apertures"]) - 1, -1, -1):
            record = self.world.arrays["apertures"][k]
            through, point = self.world.crossing(record, self.base.x[:, j - 1], self.base.v[:, j], self.base.t[:, j])
            aperture[through], crossing[through] = k, point[through]
        kinds = np.where(aperture >= 0, APERTURE + aperture, NODE)
        if j > 1:
            narrow = self.world.narrow(self.base, j - 1)
            kinds, aperture = np.where(narrow, DEVIATION, kinds), np.where(narrow, -1, aperture)
        return kinds, crossing, aperture

    def arrive(self, paths: Paths, j: int, frame: Array) -> tuple[Array, Array]:
        """(reference direction s, frame across s) at node j - 1, where ``frame`` is across the arriving direction."""
        v, surface = paths.v[:, j - 1], self.world.surface(paths, j - 1)
        s = reference_direction(surface, v)
        # reflected with the light, then turned from the mirror direction to s; refraction turns from v itself
        reflected = mirror(frame, surface.ns)
        turned = np.where((surface.lobe == TRANSMIT)[:, None], turn_minimally(frame, v, s),
                          turn_minimally(reflected, mirror(v, surface.ns), s))  # fmt: skip
        straight = (surface.lobe == REFLECT) | (surface.lobe == DIELECTRIC_REFLECT)
        return s, np.where(straight[:, None], reflected, turned)

    def moved(self, delta: Array) -> Moved:
        """The path after moving coordinates by ``delta`` (n, 2 m); directions beyond m join the old nodes."""
        base, world, m = self.base, self.world, self.m
        x, v = base.x.copy(), base.v.copy()
        paths = base
        log_jacobian = np.zeros(len(delta))
        references: list[Array] = [np.zeros((len(delta), 3))] * (base.length + 1)
        frame = self.p
        for j in range(1, m + 1):
            d = delta[:, 2 * j - 2 : 2 * j]
            s = v[:, j]
            if j > 1:
                s, frame = self.arrive(paths, j, frame)
                references[j] = s
            offset = d[:, :1] * self.e1[:, j] + d[:, 1:] * self.e2[:, j]
            towards = np.where((self.kinds[:, j] == PROJECTION)[:, None], 0, -x[:, j - 1]) + self.anchor[:, j] + offset
            aimed = unit(towards)
            omega = self.omega[:, j] + d
            rho2 = (omega**2).sum(axis=-1)
            along, across, jacobian = deviation_coefficients(rho2, self.chart)
            flat = omega[:, :1] * frame + omega[:, 1:] * np.cross(s, frame)
            deviated = along[:, None] * s + across[:, None] * flat
            kind = self.kinds[:, j]
            new = np.where((kind == DEVIATION)[:, None], deviated, aimed)
            cosine = np.where(kind == PROJECTION, dot(new, base.v[:, j]), np.abs(dot(self.normal[:, j], new)))
            with np.errstate(divide="ignore"):
                log_j = np.where(kind == PROJECTION, 3 * np.log(np.maximum(cosine, 1e-300)),
                                 np.log(np.maximum(cosine, 1e-300)) - np.log(dot(towards, towards)))  # fmt: skip
            log_jacobian = log_jacobian + np.where(kind == DEVIATION, jacobian, log_j)
            frame = turn_minimally(frame, base.v[:, 1], new) if j == 1 else turn_minimally(frame, s, new)
            # the plane of the triangle that the path met before
            ng = base.ng[:, j]
            v[:, j] = new
            reach = dot(base.x[:, j] - x[:, j - 1], ng) / dot(new, ng)
            x[:, j] = x[:, j - 1] + reach[:, None] * new
            paths = world.complete(base.length, base.ending, base.light, base.triangle, base.lobe, x)
        if m < base.length:
            references[m + 1] = reference_direction(world.surface(paths, m), paths.v[:, m])
        if m + 1 < base.length:
            references[m + 2] = reference_direction(world.surface(paths, m + 1), paths.v[:, m + 1])
        return Moved(paths, references, log_jacobian)

    def size(self) -> Array:
        """Each coordinate's own size (n, 2 m): a length where it is one, an angle else."""
        distance = np.linalg.norm(self.anchor[:, 1:] - self.base.x[:, : self.m], axis=-1)
        return np.repeat(np.where(self.kinds[:, 1:] >= NODE, distance, 1.0), 2, axis=1)

    def difference(self, function: Any, step: float) -> Array:
        """d function(Moved) / d delta (n, …, 2 m), five-point differences of ``step`` times the coordinate's size."""
        columns = []
        size = self.size()
        for k in range(2 * self.m):
            delta = np.zeros_like(size)
            delta[:, k] = step * size[:, k]
            f = [function(self.moved(scale * delta)) for scale in (-2, -1, 1, 2)]
            slope = (f[0] - 8 * f[1] + 8 * f[2] - f[3]) / 12
            columns.append(slope / delta[:, k].reshape(-1, *[1] * (slope.ndim - 1)))
        return np.stack(columns, axis=-1)


def deviation_coefficients(rho2: Array, chart: str) -> tuple[Array, Array, Array]:
    """(component along s, factor across, log dσ/dΩ) of a deviation chart."""
    if chart == "equal-area":
        return 1 - rho2 / 2, np.sqrt(np.maximum(1 - rho2 / 4, 0)), np.zeros_like(rho2)
    along = np.sqrt(np.maximum(1 - rho2, 0))
    jacobian = -np.log(np.maximum(along, 1e-300)) if chart == "orthographic" else np.zeros_like(rho2)
    return along, np.ones_like(rho2), jacobian


def reference_direction(s: Surface, v: Array) -> Array:
    """Mirror direction, refracted direction (Snell in vectors), or the normal on the side of arrival."""
    n = np.where(dot(s.ns, v)[:, None] < 0, s.ns, -s.ns)
    ratio = 1 / s.index_ratio(-v)
    across = v - dot(v, n)[:, None] * n
    tangential = ratio[:, None] * across
    down = np.sqrt(np.maximum(1 - dot(tangential, tangential), 0))[:, None]
    refracted = unit(tangential - down * n)
    out = np.where((s.lobe == DIFFUSE)[:, None], n, mirror(v, n))
    return np.where((s.lobe == TRANSMIT)[:, None], refracted, out)


# --- constraints ---------------------------------------------------------------------------------------------------


def lobe_axes(surface: Surface, v: Array, s: Array) -> tuple[Array, Array, Array]:
    """(axis in the plane of incidence, axis across it, widths (n, 2)): constraints.cl, lobe_axes, in words there."""
    n = np.where(dot(surface.ns, v)[:, None] < 0, surface.ns, -surface.ns)
    across = n - dot(n, s)[:, None] * s
    inward = np.where((dot(across, across) > 1e-8)[:, None], unit(across + 1e-300), any_tangent(s))
    sideways = np.cross(s, inward)
    ci = -dot(n, v)
    through = surface.lobe == TRANSMIT
    eta = np.where(through, 1 / surface.index_ratio(-v), 1.0)
    ct = np.where(through, np.maximum(np.abs(dot(n, s)), 0.1), -ci)
    turn = np.abs(eta * ci - ct)
    widths = np.stack([turn / np.maximum(np.abs(ct), 0.1), np.maximum(turn, 0.2)], axis=-1)
    widths = np.minimum(surface.material["alpha"].astype(float)[:, None] * widths, 1)
    return inward, sideways, np.where((surface.lobe == DIFFUSE)[:, None], 1.0, widths)


def constraint_rows(charts: Charts, step: float = 1e-4) -> tuple[Array, Array]:
    """(rows (n, r, 2m), owners (n, r)) of every constraint, each a central difference of the function that it bounds.

    All of theory.md, 5; owners name the constraint that a row belongs to, -1 with a zero row where a path lacks it.
    """
    world, base, m = charts.world, charts.base, charts.m
    n = len(base.light)
    rows: list[Array] = []
    owners: list[Array] = []
    moved_nodes = charts.difference(lambda moved: moved.paths.x, step)
    moved_directions = charts.difference(lambda moved: moved.paths.v, step)
    moved_normals = charts.difference(lambda moved: moved.paths.ns, step)
    moved_references = charts.difference(lambda moved: np.stack(moved.s, axis=1), step)
    name = 0

    def add(row: Array, mask: Array, owner: int) -> None:
        rows.append(np.where(mask[:, None], row, 0))
        owners.append(np.where(mask, owner, -1))

    everyone = np.ones(n, bool)
    for j in range(1, m + 1):
        kinds = charts.kinds[:, j]
        distance = np.where(kinds >= NODE, np.linalg.norm(charts.anchor[:, j] - base.x[:, j - 1], axis=-1), 1.0)
        bound = float(world.camera["bound"]) if j == 1 else 1.0
        for k in (0, 1):  # the bounds: one radian, one chart unit, the film
            row = np.zeros((n, 2 * m))
            row[:, 2 * j - 2 + k] = 1 / (distance * bound)
            add(row, everyone, name)
        name += 1
        for k in (0, 1):
            for index, aperture in enumerate(world.arrays["apertures"]):
                row = np.zeros((n, 2 * m))
                row[:, 2 * j - 2 + k] = 1 / aperture["half_size"][k]
                add(row, kinds == APERTURE + index, name)
                name += 1
        if j > 1:
            surface = world.surface(base, j - 1)
            inward, sideways, widths = lobe_axes(surface, base.v[:, j - 1], charts.anchor[:, j])
            for axis, width in ((inward, widths[:, 0]), (sideways, widths[:, 1])):
                row = np.zeros((n, 2 * m))
                row[:, 2 * j - 2] = dot(axis, charts.e1[:, j]) / width
                row[:, 2 * j - 1] = dot(axis, charts.e2[:, j]) / width
                add(row, kinds == DEVIATION, name)
            name += 1
        name = _object_and_normal(world, base, j, moved_nodes, moved_normals, add, name)
    for j in range(1, min(m + 1, base.length) + 1):
        for index, aperture in enumerate(world.arrays["apertures"]):
            through, _ = world.crossing(aperture, base.x[:, j - 1], base.v[:, j], base.t[:, j])
            if j <= m:
                through &= charts.kinds[:, j] != APERTURE + index

            def meet(moved: Moved, j: int = j, aperture: Any = aperture) -> Array:
                return world.crossing(aperture, moved.paths.x[:, j - 1], moved.paths.v[:, j], moved.paths.t[:, j])[1]

            if through.any():
                slope = charts.difference(meet, step)
                normal, axis = aperture["normal"].astype(float), aperture["axis"].astype(float)
                for k, e in enumerate((axis, np.cross(normal, axis))):
                    row = np.nan_to_num(np.einsum("i,nik->nk", e, slope)) / aperture["half_size"][k]
                    add(row, through, name)
                    name += 1
    if m < base.length:
        surface = world.surface(base, m)
        diffuse = surface.lobe == DIFFUSE
        s = np.where(diffuse[:, None], base.v[:, m + 1], reference_direction(surface, base.v[:, m]))
        change = moved_directions[:, m + 1] - np.where(diffuse[:, None, None], 0, moved_references[:, m + 1])
        inward, sideways, widths = lobe_axes(surface, base.v[:, m], s)
        for axis, width in ((inward, widths[:, 0]), (sideways, widths[:, 1])):
            add(np.einsum("ni,nik->nk", axis, change) / width[:, None], everyone, name)
        name += 1
    if m + 1 < base.length:
        surface = world.surface(base, m + 1)
        glossy = (surface.lobe != DIFFUSE) & bool(world.features["HAS_NARROW"])
        s = reference_direction(surface, base.v[:, m + 1])
        inward, sideways, widths = lobe_axes(surface, base.v[:, m + 1], s)
        for axis, width in ((inward, widths[:, 0]), (sideways, widths[:, 1])):
            row = np.einsum("ni,nik->nk", axis, moved_directions[:, m + 2] * 0 - moved_references[:, m + 2])
            add(row / width[:, None], glossy, name)
    return np.stack(rows, axis=1), np.stack(owners, axis=1)


def _object_and_normal(world: World, base: Paths, j: int, nodes: Array, normals: Array, add: Any, name: int) -> int:
    """The small-object and the normal constraint of node j; returns the next free name."""
    triangle = np.maximum(base.triangle[:, j], 0)
    on = base.triangle[:, j] >= 0
    thing = world.arrays["objects"][world.arrays["triangles"]["object"][triangle]]
    for k in range(3):
        axis = thing["axes"].reshape(-1, 3, 3)[:, k].astype(float)
        weight = thing["inverse_half"][:, k].astype(float)
        row = weight[:, None] * np.einsum("ni,nik->nk", axis, nodes[:, j])
        # an emitter binds the path's last node only, unless the scene has small objects: then wherever it is met
        binds = (thing["small"] != 0) & (bool(world.features["HAS_SMALL_OBJECTS"]) | (j == base.length))
        add(row, on & binds & (weight > 0), name)
    if len(world.corner_normals):
        smooth = on & (world.arrays["triangles"]["smooth"][triangle] != 0)
        corner = world.corner_normals[triangle]
        blended = np.einsum("nk,nki->ni", world.weights(triangle, base.x[:, j]), corner)
        scale = np.copysign(1 / np.maximum(np.linalg.norm(blended, axis=-1), 1e-300), dot(blended, base.ns[:, j]))
        slopes = [scale[:, None] * (corner[:, k] - corner[:, 0]) for k in (1, 2)]
        a, b = (d - dot(d, base.ns[:, j])[:, None] * base.ns[:, j] for d in slopes)
        bent = smooth & (dot(a, a) + dot(b, b) >= 1e-12)
        # any two axes across the normal: the sum of their rows' squares is the same
        first = unit(np.cross(base.ns[:, j], np.eye(3)[np.argmin(np.abs(base.ns[:, j]), axis=1)]))
        for axis in (first, np.cross(base.ns[:, j], first)):
            add(np.einsum("ni,nik->nk", axis, normals[:, j]), bent, name + 1)
    return name + 2


def preconditioner(charts: Charts, rule: str) -> Array:
    """Q (n, 2m, 2m) of eq. (21) by the package's own float64 combination."""
    rows, owners = constraint_rows(charts)
    return combine(rows, owners, rule)


def log_density(charts: Charts, moved: Moved) -> Array:
    """log of the target's density in the charts' coordinates, up to a constant: log I + Σ log dσ/dδ (+ the joint's)."""
    paths, m = moved.paths, charts.m
    total = charts.world.log_pi(paths) + moved.log_jacobian
    if m < paths.free:
        total = total + np.log(np.abs(dot(paths.ng[:, m + 1], paths.v[:, m + 1]))) - 2 * np.log(paths.t[:, m + 1])
    return total
