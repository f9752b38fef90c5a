"""`pylmc info`: what a scene compiles to, in words."""

from __future__ import annotations

from typing import Any

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
    lines += [f"  {line}" for constraint in plan.constraints for line in constraint.lines()]
    portals = features["NUM_PORTALS"]
    aimed = f"{portals} portal(s), {len(plan.aimed_objects)} small object(s)" if features["NUM_TARGETS"] else "nothing"
    lines.append(f"aimed at      {aimed}")
    lines.append("left out")
    lines += [f"  {reason}" for reason in plan.left_out]
    if not chosen.drift:
        lines.append("  the gradient of log pi: drift is off")
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
