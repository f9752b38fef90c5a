"""A description as a Mitsuba 3 scene (scalar_rgb), and independent runs of its path integrator.

What had to be said, so that both renderers are asked the same:

- ``max_depth`` counts segments in both: 1 is light seen directly, 2 one scattering. Russian roulette is off.
- ``roughconductor`` reflects on one side only, so it is wrapped in ``twosided``, as ``diffuse`` is; its ``material`` is
  "none", which is a Fresnel factor of one, and ``specular_reflectance`` takes the factor's place.
- GGX's ``alpha`` is the slope width in both. Mitsuba's masking is the separable product of Smith's terms.
- ``roughdielectric``'s inside lies against the normal, and it divides radiance that enters by eta squared, as here.
- A mesh without ``face_normals`` gets smooth normals of Mitsuba's own making; the flag is set unless there are normals.
- The film's filter is a box of one pixel, and its row 0 is at the top.
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import mitsuba as mi
import numpy as np
import trimesh

from .description import RGB, Description, Glass, Matte, Metal, Surface

mi.set_variant("scalar_rgb")
mi.set_log_level(mi.LogLevel.Error)


def _rgb(value: RGB) -> dict[str, Any]:
    return {"type": "rgb", "value": list(value)}


def _bsdf(material: Matte | Metal | Glass) -> dict[str, Any]:
    if isinstance(material, Glass):
        return {
            "type": "roughdielectric",
            "distribution": "ggx",
            "alpha": material.alpha,
            "int_ior": material.ior,
            "ext_ior": 1.0,
        }
    if isinstance(material, Metal):
        inner = {
            "type": "roughconductor",
            "distribution": "ggx",
            "alpha": material.alpha,
            "material": "none",
            "specular_reflectance": _rgb(material.reflectance),
        }
    else:
        inner = {"type": "diffuse", "reflectance": _rgb(material.reflectance)}
    return {"type": "twosided", "inner": inner}


def _shape(surface: Surface, file: Path) -> dict[str, Any]:
    smooth = surface.normals is not None
    mesh = trimesh.Trimesh(surface.vertices, surface.faces, vertex_normals=surface.normals, process=False)
    file.write_bytes(mesh.export(file_type="ply", vertex_normal=smooth))
    shape: dict[str, Any] = {"type": "ply", "filename": str(file), "face_normals": not smooth, "bsdf": _bsdf(surface.material)}
    if surface.emission is not None:
        shape["emitter"] = {"type": "area", "radiance": _rgb(surface.emission)}
    return shape


def mitsuba_scene(description: Description) -> Any:
    """The description as a loaded Mitsuba scene."""
    view = description.view
    to_world = mi.ScalarTransform4f().look_at(origin=list(view.origin), target=list(view.target), up=list(view.up))
    film = {
        "type": "hdrfilm",
        "width": view.size[0],
        "height": view.size[1],
        "rfilter": {"type": "box"},
        "pixel_format": "rgb",
        "component_format": "float32",
    }
    scene: dict[str, Any] = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": description.depth, "rr_depth": 1000},
        "sensor": {
            "type": "perspective",
            "fov": view.fov,
            "fov_axis": "y",
            "near_clip": 1e-3,
            "far_clip": 1e3,
            "to_world": to_world,
            "film": film,
            "sampler": {"type": "independent"},
        },
    }
    for number, point in enumerate(description.points):
        scene[f"point{number}"] = {"type": "point", "position": list(point.position), "intensity": _rgb(point.intensity)}
    with tempfile.TemporaryDirectory() as folder:
        for number, surface in enumerate(description.surfaces):
            scene[f"shape{number}"] = _shape(surface, Path(folder) / f"{number}.ply")
        return mi.load_dict(scene)


def mitsuba_runs(description: Description, runs: int, samples: int, first_seed: int = 0) -> np.ndarray:
    """Pictures (runs, height, width, 3) of ``samples`` samples per pixel each."""
    scene = mitsuba_scene(description)
    pictures = [np.array(mi.render(scene, seed=first_seed + run, spp=samples)) for run in range(runs)]
    return np.stack(pictures).astype(np.float64)
