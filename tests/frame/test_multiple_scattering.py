"""The setting `multiple_scattering` in whole pictures."""

import numpy as np
import pytest

from raysvc.frame.render import render
from raysvc.scene import Material
from tests.frame.subjects import ball, constant_environment

VIEW = {"eye": [0, 0, 4], "target": [0, 0, 0], "fov_y_deg": 40.0, "width": 48, "height": 48}


def seen(material, **settings):
    """(N, 3) what pixels show of a ball under constant light."""
    settings = {"aa": "none", "lens": "none", **settings}
    frame = render(ball(material), constant_environment(), VIEW, settings)
    return frame.layers["beauty"][frame.layers["id"] >= 0][:, :3]


@pytest.mark.parametrize("roughness", [0.2, 0.5, 0.6, 1.0])
def test_a_white_metal_ball_vanishes_in_a_furnace(roughness):
    white = Material(metallic=1.0, roughness=roughness)
    np.testing.assert_allclose(seen(white, multiple_scattering=True), 1.0, rtol=1e-3)
    lost = 1.0 - seen(white).mean()
    assert 0.4 * roughness**4 < lost < 0.6 and lost > 5e-4


def test_reference_mode_compensates_the_same_lobe():
    white = Material(metallic=1.0, roughness=0.9)
    paths = {"mode": "reference", "samples": 64}
    assert seen(white, **paths, multiple_scattering=True).mean() == pytest.approx(1.0, rel=5e-3)
    once, hybrid = seen(white, **paths).mean(), seen(white).mean()
    assert once < 0.8 and once == pytest.approx(hybrid, rel=1e-2)


def test_colours_of_rough_metal_saturate():
    gold = Material(metallic=1.0, roughness=0.9, base_colour=(1.0, 0.7, 0.3, 1.0))
    once, more = seen(gold).mean(axis=0), seen(gold, multiple_scattering=True).mean(axis=0)
    assert (more > 1.05 * once).all()
    assert more[2] / more[0] < 0.95 * once[2] / once[0]
