"""The scene as arrays for the device: triangles, materials, lights, and the constants that specialise the kernels.

Positions are moved and scaled so that the scene's centre is the origin and its radius about one (the scale is a power
of two, so that nothing is rounded by it), in float64, before they become float32; light is scaled so that its power is
about one. A scene far from the origin, very small, very large, very bright or very dim therefore renders alike.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..constraints.constraint import Found
from ..constraints.lobes import NARROW_ALPHA
from ..constraints.plan import plan_constraints
from ..device import tables
from ..device.compiled_scene import CompiledScene
from ..device.precision import nominal, real_fields
from ..errors import PylmcError
from ..geometry import bvh
from ..geometry.mesh import Mesh, Part, join
from ..geometry.objects import SceneObject, find_objects
from ..geometry.portals import find_portals
from ..lobes import KINDS, REFERENCES, Lobe
from ..scene import Portal, Scene, Shape, Texture
from ..scene.lights.light import INFINITY, Placement
from .compiled_lights import light_arrays, power_of_two
from .evenness import GRID
from .ties import find_ties


def compile_scene(scene: Scene, precision: str = "single") -> CompiledScene:
    """Everything the kernels need of ``scene``, with reals rounded as ``precision`` holds them (see pylmc.device.precision).

    Raises PylmcError for what the number type or the kernels cannot hold.
    """
    kind = nominal(precision)
    mesh = join([_part(shape) for shape in scene.shapes])
    faces, shape_of = mesh.faces, mesh.shape_of_face

    used = mesh.vertices[np.unique(faces)]
    low, high = used.min(axis=0), used.max(axis=0)
    centre, radius = (low + high) / 2, float(np.linalg.norm(high - low) / 2)
    if not radius > 0 or not np.isfinite(radius):
        raise PylmcError("Scene: all vertices coincide; there is nothing to see")
    scale = power_of_two(radius)
    vertices = (mesh.vertices - centre) / scale

    objects, object_of = find_objects(mesh)
    portals = _all_portals(scene, mesh)
    plan = plan_constraints(Found(scene, objects, portals, radius))
    placement = Placement(centre, scale, radius / scale)
    constraints = [constraint.records(placement) for constraint in plan.constraints]
    corners = vertices[faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    doubled = np.linalg.norm(cross, axis=1)
    normals = cross / np.where(doubled > 0, doubled, 1)[:, None]

    materials, material_of_shape, lobe_kinds = _materials(scene.shapes)
    lights = light_arrays(scene, doubled / 2, shape_of, placement)
    triangles = np.zeros(len(faces), tables.TRIANGLE_INFO)
    triangles["normal"] = np.where(doubled[:, None] > 0, normals, [0.0, 0.0, 1.0])
    triangles["material"] = material_of_shape[shape_of]
    triangles["object"] = object_of
    triangles["emitter"] = lights.emitter_of_shape[shape_of]
    triangles["smooth"] = mesh.smooth[shape_of]

    tree = bvh.build(vertices, faces.astype(np.int32), dtype=kind.trace_dtype)
    arrays = {
        "nodes": tree.nodes,
        "leaves": tree.leaves,
        "vertices": vertices,
        "faces": faces.astype(np.int32),
        "normals": mesh.normals,
        "uvs": mesh.uvs,
        "triangles": triangles,
        **materials,
        **lights.arrays,
        **{name: records for of_kind in constraints for name, records in of_kind.items()},
        "camera": _camera(scene, centre, scale),
        "evenness": np.ones((GRID, GRID), np.float32),
        "ties": find_ties(scene, mesh, corners, normals, _transmit(materials)[triangles["material"]], kind.trace),
    }
    arrays["targets"] = _targets(arrays["portals"], objects, plan.aimed_objects, placement)
    for name in (name for name, kind in tables.SCENE_ARRAYS.items() if kind not in tables.FIXED_TYPES):
        arrays[name] = arrays[name].astype(real_fields(arrays[name].dtype, kind.host), copy=False)
    features = tree.defines() | {
        "HAS_LIGHTS": len(scene.lights) > 0,
        "HAS_EMITTERS": len(arrays["emitter_triangles"]) > 0,
        "NUM_LIGHTS": len(scene.lights),
        "HAS_INFINITE": any(light.place == INFINITY for light in scene.lights),
        "NUM_EMITTER_TRIANGLES": len(arrays["emitter_triangles"]),
        "NUM_TARGETS": len(arrays["targets"]),
        "HAS_PAIRS": any(kind.pair for kind in lobe_kinds),
        "HAS_NARROW": bool(arrays["lobes"]["narrow"].any()),
        "HAS_SMOOTH": bool(mesh.smooth.any()),
        "HAS_TEXTURES": len(arrays["textures"]) > 0,
        "HAS_TIES": len(arrays["ties"]) > 0,
    }
    for constraint in plan.constraints:
        features |= constraint.features()
    endings = tuple(e for e, has in enumerate((features["HAS_LIGHTS"], features["HAS_EMITTERS"])) if has)
    return CompiledScene(
        mesh,
        portals,
        tuple(objects),
        plan,
        arrays,
        features,
        lobe_kinds,
        lights.kinds,
        endings,
        centre,
        scale,
        lights.radiance_scale,
    )


def _part(shape: Shape) -> Part:
    return Part(shape.vertices, shape.faces, shape.vertex_normals(), shape.uv if shape.textured else None)


def _all_portals(scene: Scene, mesh: Mesh) -> tuple[Portal, ...]:
    """The portals that the scene names, or else the holes in its walls."""
    return tuple(Portal(*hole) for hole in find_portals(mesh)) if scene.portals == "auto" else scene.portals


def _materials(shapes: Sequence[Shape]) -> tuple[dict[str, np.ndarray], np.ndarray, tuple[type[Lobe], ...]]:
    """Materials, their lobes and textures as arrays; each shape's material; the kinds of lobes there are."""
    found = list({id(shape.material): shape.material for shape in shapes}.values())
    index_of = {id(material): index for index, material in enumerate(found)}
    lobes = [material.lobes() for material in found]
    kinds = tuple(kind for kind in KINDS if any(isinstance(lobe, kind) for of_one in lobes for lobe in of_one))
    textures = list({id(m.texture): m.texture for m in found if m.texture is not None}.values())
    records = np.zeros(len(found), tables.MATERIAL)
    for record, material, of_one in zip(records, found, lobes, strict=True):
        record["lobes"], record["choices"] = len(of_one), sum(lobe.pair >= 0 for lobe in of_one)
        record["texture"] = next((i for i, texture in enumerate(textures) if texture is material.texture), -1)
    records["first_lobe"] = np.cumsum(records["lobes"]) - records["lobes"]
    layout = tables.lobe_record(kinds)
    arrays = {"materials": records, "lobes": np.concatenate([_lobe_records(of_one, layout) for of_one in lobes])}
    of_shape = np.array([index_of[id(shape.material)] for shape in shapes])
    return arrays | _textures(textures), of_shape, kinds


def _lobe_records(lobes: Sequence[Lobe], layout: list[Any]) -> np.ndarray:
    """One material's lobes; the two of a pair have the reflecting one's share together."""
    records = np.zeros(len(lobes), layout)
    shares = np.array([lobe.share if lobe.pair >= 0 else 0.0 for lobe in lobes])
    upto = np.cumsum(shares) / shares.sum()
    upto[-1] = 1.0
    before = np.append(0.0, upto[:-1])
    for i, lobe in enumerate(lobes):
        record, first = records[i], i - (lobe.pair < 0)
        record["choose"], record["choose_before"] = upto[first], before[first]
        record["kind"] = KINDS.index(type(lobe))
        record["signature"] = record["kind"] + len(KINDS) * sum(type(other) is type(lobe) for other in lobes[:i])
        record["reference"], record["pair"] = REFERENCES.index(lobe.reference), lobe.pair
        record["narrow"] = lobe.width is not None and lobe.width < NARROW_ALPHA
        for name, value in lobe.values().items():
            record[name] = value
    return records


def _transmit(materials: dict[str, np.ndarray]) -> np.ndarray:
    """Whether light passes through each material."""
    lobes = materials["lobes"]["pair"] < 0
    return np.logical_or.reduceat(lobes, materials["materials"]["first_lobe"])


def _textures(textures: Sequence[Texture]) -> dict[str, np.ndarray]:
    info = np.zeros(len(textures), tables.TEXTURE_INFO)
    offset = 0
    for entry, texture in zip(info, textures, strict=True):
        entry["height"], entry["width"] = texture.pixels.shape[:2]
        entry["offset"] = offset
        offset += entry["height"] * entry["width"]
    texels = [texture.pixels.reshape(-1, 3) for texture in textures]
    return {"textures": info, "texels": np.concatenate(texels) if texels else np.zeros((0, 3), np.float32)}


def _camera(scene: Scene, centre: np.ndarray, scale: float) -> np.ndarray:
    camera = scene.camera
    record = np.zeros(1, tables.CAMERA)
    record["origin"] = (camera.origin - centre) / scale
    record["right"], record["up"], record["forward"] = camera.axes()
    tan_y = np.tan(np.radians(camera.fov) / 2)
    record["tan_y"], record["tan_x"] = tan_y, tan_y * camera.width / camera.height
    record["bound"] = min(1.0, float(record["tan_x"][0]), float(record["tan_y"][0]))
    record["width"], record["height"] = camera.width, camera.height
    return record


def _targets(holes: np.ndarray, objects: Sequence[SceneObject], aimed: Sequence[int], placement: Placement) -> np.ndarray:
    """What paths are aimed at: all portals, whose records are ``holes``, and some objects."""
    records = np.zeros(len(holes) + len(aimed), tables.TARGET)
    for name in ("centre", "normal", "axis", "half_size"):
        records[name][: len(holes)] = holes[name]
    for record, index in zip(records[len(holes) :], aimed, strict=True):
        record["centre"] = placement.of(objects[index].centre)
        record["half_size"] = objects[index].bounding_radius / placement.scale
        record["sphere"] = 1
    return records
