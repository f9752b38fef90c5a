"""Which constraints a scene has, and how they combine into the preconditioner (paper, section 4; theory.md, 5).

:func:`plan_constraints` reads the scene and decides: kinds, widths, what is infinite and left out. Its result
specialises the kernels. :func:`combine` and :func:`proposal_factor` are the combination itself in float64 NumPy, the
reference that the kernels are tested against.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import PylmcError
from ..geometry.objects import SceneObject
from ..scene import Material, Portal, Scene

NARROW_ALPHA = 0.3  # lobes narrower than this leave by the deviation chart, wider ones by a target chart
SMALL = 0.1  # an object is small, in units of the scene's radius, if two of its half-extents are below this
WIDE_PORTAL = 0.5  # a hole wider than this constrains nothing
FLAT = 1e-4  # half-extents below this part of the largest are no extent at all: the node is on the surface anyway
MAX_PORTALS = 16
AIM_RADIUS, MAX_AIMED_OBJECTS = 0.05, 8


@dataclass(frozen=True)
class ConstraintPlan:
    """The constraints that a scene has. Sizes are relative to the scene's radius.

    ``object_weights`` (objects, 3) are inverse half-extents along each object's axes, in inverse scene units, 0 where the
    constraint is infinite: those of the ``small_objects``, and of the ``emitters`` among the objects, on which paths that
    hit must land and which count as small at any size. ``aimed_objects`` indexes the objects that the independent sampler
    aims at. ``left_out`` says in words what was dropped and why.
    """

    narrow_materials: tuple[str, ...]
    glossy_materials: int
    portals: tuple[Portal, ...]
    object_weights: np.ndarray
    small_objects: int
    emitters: int
    aimed_objects: tuple[int, ...]
    curved_shapes: int
    left_out: tuple[str, ...] = ()


def alpha_of(material: Material) -> float | None:
    """GGX alpha of a material's narrowest lobe, or None where all have a constant width."""
    return min((lobe.width for lobe in material.lobes() if lobe.width is not None), default=None)


def plan_constraints(scene: Scene, objects: Sequence[SceneObject], portals: Sequence[Portal], radius: float) -> ConstraintPlan:
    """Decide which constraints ``scene`` has, given what was found in it; ``radius`` is its, in scene units."""
    left_out: list[str] = []
    alphas = {id(s.material): (s.name or f"shape {i}", alpha_of(s.material)) for i, s in enumerate(scene.shapes)}
    glossy = [(name, alpha) for name, alpha in alphas.values() if alpha is not None]
    narrow = tuple(name for name, alpha in glossy if alpha < NARROW_ALPHA)
    left_out += [
        f"lobe of '{name}': alpha={a:g} is wide, its directions take target charts" for name, a in glossy if a >= NARROW_ALPHA
    ]

    narrow_portals = [a for a in portals if min(a.half_size) <= WIDE_PORTAL * radius]
    if len(narrow_portals) < len(portals):
        left_out.append(f"{len(portals) - len(narrow_portals)} portal(s) wider than {WIDE_PORTAL:g} scene radii")
    if len(narrow_portals) > MAX_PORTALS:
        left_out.append(f"{len(narrow_portals) - MAX_PORTALS} portal(s) beyond the {MAX_PORTALS} smallest")
        narrow_portals = sorted(narrow_portals, key=lambda a: a.half_size[0] * a.half_size[1])[:MAX_PORTALS]

    emitting = {i for i, shape in enumerate(scene.shapes) if shape.emission}
    weights = np.zeros((len(objects), 3))
    small = 0
    for index, item in enumerate(objects):
        half = np.asarray(item.half_extents)
        extended = half > FLAT * half.max()
        if item.shape in emitting:
            weights[index, extended] = 1 / half[extended]
        elif np.sort(half)[1] < SMALL * radius:
            bounded = extended & (half < SMALL * radius)
            weights[index, bounded] = 1 / half[bounded]
            small += 1
    large = sum(item.shape not in emitting for item in objects) - small
    if large:
        left_out.append(f"{large} object(s) that are not small (two half-extents below {SMALL:g} scene radii)")

    aimed = [i for i, item in enumerate(objects) if item.bounding_radius < AIM_RADIUS * radius and item.shape not in emitting]
    if len(aimed) > MAX_AIMED_OBJECTS:
        left_out.append(f"aiming at {len(aimed)} small objects: more than {MAX_AIMED_OBJECTS}, none is special")
        aimed = []
    curved = sum(bool(shape.smooth) for shape in scene.shapes)
    return ConstraintPlan(
        narrow,
        len(glossy),
        tuple(narrow_portals),
        weights,
        small,
        sum(item.shape in emitting for item in objects),
        tuple(aimed),
        curved,
        tuple(left_out),
    )


def combine(rows: np.ndarray, owners: np.ndarray, rule: str = "sum") -> np.ndarray:
    """Q of eq. (21), batched: w(M) times the sum of the constraints' row wᵀ row.

    ``rows`` (..., rows, n) are the constraints' differentials, already divided by their widths q (zero rows are
    absent constraints); ``owners`` (..., rows) names the constraint of each row, so that M counts constraints and not
    rows. Returns (..., n, n) float64.
    """
    rows = np.asarray(rows, dtype=np.float64)
    q = np.einsum("...ri,...rj->...ij", rows, rows)
    if rule == "sum":
        return q
    present = np.any(rows != 0, axis=-1)
    flat_present, flat_owners = present.reshape(-1, present.shape[-1]), np.broadcast_to(owners, present.shape)
    flat_owners = flat_owners.reshape(flat_present.shape)
    m = np.array([len(np.unique(o[p])) for o, p in zip(flat_owners, flat_present, strict=True)], dtype=np.float64)
    m = np.maximum(m, 1).reshape(present.shape[:-1])
    if rule == "mean":
        return q / m[..., None, None]
    if rule == "rms":
        return q / np.sqrt(m)[..., None, None]
    raise PylmcError(f"rule={rule!r} is unknown; choose from sum, mean, rms")


def proposal_factor(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(T, log |det T|) with T Tᵀ = Q⁻¹, from Q = L Lᵀ as T = L⁻ᵀ; batched over leading axes, float64."""
    factor = np.linalg.cholesky(np.asarray(q, dtype=np.float64))
    diagonal = np.diagonal(factor, axis1=-2, axis2=-1)
    return np.swapaxes(np.linalg.inv(factor), -1, -2), -np.log(diagonal).sum(axis=-1)
