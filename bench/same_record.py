"""Pictures and counters of a fixed amount of work, for `bench.same`: run by path, in a process of its own, on any checkout.

It uses the public interface alone, as of the first release, so that it can be run on commits older than itself.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

# An editable installation would offer its own checkout's parts to another checkout's package.
sys.meta_path[:] = [finder for finder in sys.meta_path if not getattr(finder, "__module__", "").startswith("__editable__")]

import numpy as np  # noqa: E402
import trimesh  # noqa: E402

import pylmc  # noqa: E402

SIDE = 48  # pixels
WORK = {"lmc": 60, "bdpt": 60, "path": 8}  # mutations or samples per pixel
SCENES, PRECISIONS = ("keyhole", "glints", "caustic", "box"), ("single", "mixed", "double", "float-float")
COUNTERS = ("mutations", "samples", "acceptance", "rays", "not_finite_rejected", "b", "mean_luminance")


def textured() -> Any:
    """Textured surfaces of two lobes, smooth and flat, under an emitting panel and a point light."""
    y, x = np.mgrid[0:8, 0:8]
    texture = pylmc.Texture(np.stack([(x + y) % 2 * 0.6 + 0.2, x / 8, y / 8], axis=-1))
    floor = trimesh.Trimesh(
        [[-2, 0, -2], [-2, 0, 2], [2, 0, 2], [2, 0, -2]],
        [[0, 1, 2], [0, 2, 3]],
        process=False,
        visual=trimesh.visual.TextureVisuals(uv=[[0, 0], [0, 3], [3, 3], [3, 0]]),
    )
    panel = ([[-0.5, 2, -0.5], [0.5, 2, -0.5], [0.5, 2, 0.5], [-0.5, 2, 0.5]], [[0, 1, 2], [0, 2, 3]])
    ball = trimesh.creation.icosphere(subdivisions=2, radius=0.5).apply_translation([0, 0.6, 0])
    shapes = [
        pylmc.Shape(floor, pylmc.MetallicRoughness(texture, 0.4, 0.3), name="floor"),
        pylmc.Shape(ball, pylmc.RoughDielectric(0.05, 1.5), name="ball", smooth=True),
        pylmc.Shape(panel, pylmc.Diffuse(0.5), emission=4.0, name="panel"),
    ]
    lights = [pylmc.PointLight((1.5, 1.8, 1.2), 3.0)]
    return pylmc.Scene(pylmc.Camera((0, 1.2, 3), (0, 0.5, 0), fov=45, width=SIDE, height=SIDE), shapes, lights)


def gltf() -> Any:
    """A GLB file written by trimesh, framed and lit on request."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.glb"
        ball = trimesh.creation.icosphere(subdivisions=2)
        box = trimesh.creation.box((3, 0.2, 3)).apply_translation([0, -1.2, 0])
        path.write_bytes(trimesh.Scene([ball, box]).export(file_type="glb"))
        return pylmc.load(path, width=SIDE, height=SIDE, auto_camera=True, auto_light=True)


def built_in(name: str) -> Callable[[], Any]:
    return lambda: pylmc.load(name, width=SIDE, height=SIDE)


def cases(quick: bool) -> dict[str, tuple[Callable[[], Any], dict[str, Any]]]:
    """Name of each case: its scene and the arguments of `render`."""
    found: dict[str, tuple[Callable[[], Any], dict[str, Any]]] = {}
    for precision in PRECISIONS[:1] if quick else PRECISIONS:
        for scene in SCENES:
            for integrator in WORK:
                found[f"{scene} {integrator} {precision}"] = built_in(scene), {"integrator": integrator, "precision": precision}
    for integrator in WORK:
        found[f"textured {integrator}"] = textured, {"integrator": integrator}
        found[f"gltf {integrator}"] = gltf, {"integrator": integrator}
    options: dict[str, dict[str, Any]] = {
        "drift": {"drift": True},
        "deviation": {"coordinates": "deviation"},
        "drift deviation": {"drift": True, "coordinates": "deviation", "chart": "orthographic"},
        "rms reduced": {"rule": "rms", "differentials": "reduced"},
        "plain": {"even": False, "constraints": (), "aim": "light"},
        "projection": {"coordinates": "deviation", "projection": "orthographic", "rule": "mean", "blocks": False},
    }
    for name, chosen in options.items():
        found[f"caustic {name}"] = built_in("caustic"), chosen
        found[f"textured {name}"] = textured, chosen
    found["keyhole drift"] = built_in("keyhole"), options["drift"]
    found["keyhole deviation"] = built_in("keyhole"), options["deviation"]
    return found


def record(scene: Callable[[], Any], chosen: dict[str, Any]) -> tuple[np.ndarray, dict[str, Any]]:
    integrator = chosen.get("integrator", "lmc")
    picture = pylmc.render(
        scene(),
        mutations_per_pixel=WORK[integrator],
        seed=5,
        max_depth=5,
        progress=False,
        **{"integrator": integrator, **chosen},
    )
    told = picture.diagnostics
    return picture.image, {key: told[key] for key in COUNTERS if key in told} | {"device": told["device"]}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--only", default="")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    options.out.mkdir(parents=True, exist_ok=True)
    for name, (scene, chosen) in cases(options.quick).items():
        if options.only not in name:
            continue
        try:
            image, counters = record(scene, chosen)
        except Exception as error:  # a commit on which a case fails is a finding, not the end of the comparison
            image, counters = np.zeros(0, np.float32), {"failed": f"{type(error).__name__}: {error}"}
        np.save(options.out / f"{name.replace(' ', '_')}.npy", image)
        entry = {"sha256": hashlib.sha256(image.tobytes()).hexdigest(), **counters}
        (options.out / f"{name.replace(' ', '_')}.json").write_text(json.dumps(entry, indent=1) + "\n", encoding="utf-8")
        print(".", end="", flush=True)
    print()


if __name__ == "__main__":
    main()
