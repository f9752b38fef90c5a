"""`pylmc info`: what a scene compiles to, in words."""

from __future__ import annotations

from typing import Any

import numpy as np

from .constraints.plan import MAX_PORTALS, NARROW_ALPHA
from .sampling.compiled import CompiledScene, compile_scene
from .sampling.limits import limits
from .scene import Scene
from .settings import Settings, explained

ENDING_WORDS = ("connect (to a light without area)", "hit (an emitter)")


@explained(Settings)
def info(scene: Scene, precision: str = "single", **settings: Any) -> str:
    """Path lengths, lobes, constraints by kind and count, and what was left out and why; as lines of text.

    ``precision``: whose limits are told (see :mod:`pylmc.sampling.limits`). Needs no OpenCL device.
    """
    chosen = Settings.given(settings)
    compiled = compile_scene(scene, precision)
    plan, features = compiled.plan, compiled.features
    camera = scene.camera
    low = 2 if compiled.endings == (0,) else 1
    lobes = [kind.name.replace("_", " ") for kind in compiled.lobe_kinds]
    triangles = len(compiled.arrays["faces"])
    lines = [
        f"film          {camera.width} x {camera.height}, vertical field of view {camera.fov:g} degrees",
        f"geometry      {len(scene.shapes)} shapes, {len(compiled.objects)} objects, {triangles} triangles; "
        f"radius {compiled.scale:.3g} to {2 * compiled.scale:.3g}",
        f"light         {_lights(scene)}{features['NUM_EMITTER_TRIANGLES']} emitting triangle(s)",
        f"portals       {_portals(scene, compiled)}",
        f"paths         {low} to {chosen.max_depth} segments; ending: {', '.join(ENDING_WORDS[e] for e in compiled.endings)}",
        f"lobes         {', '.join(lobes)}",
        f"coordinates   {chosen.coordinates} charts; deviations by the {chosen.chart} chart",
        f"combination   Q = w(M) sum Q_k / q_k^2, rule '{chosen.rule}'; drift {'on' if chosen.drift else 'off'}",
        "constraints",
        "  bounds      always: one radian or chart unit per direction (the film for the first)",
    ]
    if plan.narrow_materials:
        names = ", ".join(plan.narrow_materials[:6]) + (", ..." if len(plan.narrow_materials) > 6 else "")
        lines.append(f"  lobes       {len(plan.narrow_materials)} narrow material(s), alpha < {NARROW_ALPHA:g}: {names}")
    if plan.portals:
        sizes = ", ".join("x".join(f"{2 * h:.3g}" for h in a.half_size) for a in plan.portals[:6])
        lines.append(f"  portals     {len(plan.portals)} portal(s) of at most {MAX_PORTALS}, sizes {sizes}")
    if plan.small_objects:
        halves = [
            item.half_extents
            for item, w in zip(compiled.objects, plan.object_weights, strict=True)
            if np.any(w > 0) and not scene.shapes[item.shape].emission
        ]
        sizes = ", ".join("x".join(f"{2 * h:.2g}" for h in half) for half in halves[:6])
        more = ", ..." if len(halves) > 6 else ""
        lines.append(f"  objects     {plan.small_objects} small object(s), sizes {sizes}{more}")
    if plan.emitters:
        lines.append(f"  emitters    {plan.emitters} emitting object(s), for paths that end on one")
    if plan.curved_shapes:
        lines.append(f"  normals     {plan.curved_shapes} shape(s) with smooth normals")
    aimed = len(plan.portals) + len(plan.aimed_objects)
    lines.append(
        f"aimed at      {len(plan.portals)} portal(s), {len(plan.aimed_objects)} small object(s)"
        if aimed
        else "aimed at      nothing"
    )
    lines.append("left out")
    lines += [f"  {reason}" for reason in _left_out(compiled, chosen)]
    lines.append("compiled in   " + ", ".join(sorted(k for k, v in features.items() if k.startswith("HAS_") and v)))
    out = sorted(k for k, v in features.items() if k.startswith("HAS_") and not v)
    lines.append("compiled out  " + (", ".join(out) or "nothing"))
    beyond = limits(scene, compiled, precision)
    lines += [f"limits        of precision '{precision}': {'' if beyond else 'nothing in this scene is beyond them'}".rstrip()]
    lines += [f"  {sentence}" for sentence in beyond]
    return "\n".join(lines)


def _lights(scene: Scene) -> str:
    """How many lights without area there are of each kind."""
    names = [light.name for light in scene.lights]
    return "".join(f"{names.count(name)} {name} light(s), " for name in dict.fromkeys(names))


def _portals(scene: Scene, compiled: CompiledScene) -> str:
    """How many holes light passes, who says so, and where the first few are."""
    origin = "found (inner boundary loops of open planar pieces)" if scene.portals == "auto" else "given"
    places = ["at (" + ", ".join(f"{x:.3g}" for x in portal.centre) + ")" for portal in compiled.portals[:3]]
    more = ", ..." if len(compiled.portals) > 3 else ""
    return f"{len(compiled.portals)} {origin}{': ' if places else ''}{', '.join(places)}{more}"


def _left_out(compiled: CompiledScene, chosen: Settings) -> list[str]:
    plan, features = compiled.plan, compiled.features
    reasons = list(plan.left_out)
    if not features["HAS_NARROW"]:
        reasons.append("lobe constraints: no lobe is narrow")
    if not compiled.portals:
        reasons.append("portal constraints: the scene has no portal (inner boundary loop of an open planar piece)")
    if not plan.small_objects:
        reasons.append("object constraints: no object is small")
    if not plan.curved_shapes:
        reasons.append("normal constraints: all faces are flat")
    if not chosen.drift:
        reasons.append("the gradient of log pi: drift is off")
    return reasons
