"""Plastic against Mitsuba 3's roughplastic, direction by direction: no picture, no sampling."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("mitsuba", reason="the independent renderer; install with pip install -e .[mitsuba]")

import mitsuba as mi
from oracle.vectors import dot, unit
from studies.lobes import CASES, MATERIALS, NORMAL, Lobes

from pylmc.scene import Plastic

SEPARABLE = [i for i, m in enumerate(MATERIALS) if isinstance(m, Plastic) and m.masking == "separable"]


@pytest.mark.parametrize("index", SEPARABLE, ids=lambda index: f"alpha-{MATERIALS[index].alpha}")
def test_values_are_roughplastics(index: int) -> None:
    """f |cos| of base and coat together, on the side that roughplastic has; half of the directions near the peak."""
    material, lobes = MATERIALS[index], Lobes()
    mi.set_variant("scalar_rgb")
    theirs = mi.load_dict(
        {
            "type": "roughplastic",
            "distribution": "ggx",
            "alpha": material.alpha,
            "int_ior": material.ior,
            "ext_ior": 1.0,
            "nonlinear": False,
            "diffuse_reflectance": {"type": "rgb", "value": list(material.reflectance)},
        }
    )
    rng, n = np.random.default_rng(3), 2000
    wi, facet = unit(rng.normal(size=(n, 3))), unit(NORMAL + 2 * material.alpha * rng.normal(size=(n, 3)))
    wo = np.where(np.arange(n)[:, None] % 2, 2 * dot(wi, facet)[:, None] * facet - wi, unit(rng.normal(size=(n, 3))))
    above = (wi @ NORMAL > 0.05) & (wo @ NORMAL > 0.05)
    wi, wo = wi[above], wo[above]
    ours = sum(lobes.evaluate(index, lobe, NORMAL, NORMAL, wi, wo)[0] for case, lobe in CASES if case == index)
    tangent = unit(np.cross(NORMAL, [1.0, 0.0, 0.0]))
    frame = np.stack([tangent, np.cross(NORMAL, tangent), NORMAL], axis=1)
    si, context, expected = mi.SurfaceInteraction3f(), mi.BSDFContext(), []
    for i, o in zip(wi @ frame, wo @ frame, strict=True):
        si.wi = mi.Vector3f(*i)
        expected.append(list(theirs.eval(context, si, mi.Vector3f(*o))))
    # their table is float32, summed over fewer facets than ours; a narrow peak turns float32 directions into a few 1e-4
    assert len(ours) > 300
    np.testing.assert_allclose(ours, expected, rtol=3e-3, atol=1e-6)
