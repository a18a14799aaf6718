"""Brushed metal in whole pictures: hybrid mode beside reference mode."""

from dataclasses import replace

import numpy as np
import pytest

from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import sheet, sphere
from raysvc.frame.render import render
from raysvc.scene import Environment, Material, PunctualLight
from tests.frame.subjects import GREY, ball, constant_environment
from tests.lighting.test_image_light import smooth_sky

STEEL = Material(metallic=1.0, roughness=0.25, anisotropy=0.8)
VIEW = {"eye": [0, 0, 4], "target": [0, 0, 0], "fov_y_deg": 40.0, "width": 48, "height": 48}


def shown(scene, environment, **settings):
    frame = render(scene, environment, VIEW, {"aa": "none", "lens": "none", **settings})
    return frame.layers["beauty"][..., :3], frame.layers["id"] >= 0


@pytest.mark.parametrize("material", [STEEL, replace(STEEL, roughness=0.6)])
def test_a_ball_under_a_sky_looks_as_in_reference_mode(material):
    scene, sky = ball(material), Environment(smooth_sky())
    hybrid, seen = shown(scene, sky)
    truth, _ = shown(scene, sky, mode="reference", samples=256)
    # But for the rim, where a pixel's centre and its mean are not the same
    inner = seen & np.roll(seen, 3, 0) & np.roll(seen, -3, 0) & np.roll(seen, 3, 1)
    inner &= np.roll(seen, -3, 1)
    error = np.abs(hybrid - truth)[inner] / truth[inner]
    assert error.mean() < 0.06
    round_, _ = shown(ball(replace(material, anisotropy=0.0)), sky)
    assert np.abs(round_ - truth)[inner].mean() > 2 * np.abs(hybrid - truth)[inner].mean()


def test_it_is_compensated_for_multiple_scattering():
    white = replace(STEEL, roughness=0.8)
    lit, seen = shown(ball(white), constant_environment(), multiple_scattering=True)
    np.testing.assert_allclose(lit[seen], 1.0, rtol=1e-3)
    once, _ = shown(ball(white), constant_environment())
    assert once[seen].mean() < 0.85


def test_the_scene_is_mirrored_along_the_brushing():
    """A plate brushed along x below a bright ball: rays spread its image along x."""
    bright = Material(base_colour=(0, 0, 0, 1), metallic=0.0, emissive=(3.0, 3.0, 3.0), unlit=False)
    parts = [
        Part(sheet(6.0, 6.0, 1, 1), 0),
        Part(sphere(0.35, 16).moved([0.0, 0.8, -0.6]), 1),
    ]
    dark = constant_environment(0.02)
    view = VIEW | {"eye": [0, 1.6, 3.0], "target": [0, 0, 0]}

    def spread(plate, **settings):
        frame = render(
            scene_of("plate", parts, [plate, bright]),
            dark,
            view,
            {"aa": "none", "lens": "none", "shadows": False, **settings},
        )
        light = frame.layers["beauty"][..., 0] * (frame.layers["material"] == 0)
        y, x = np.mgrid[0:48, 0:48]
        mean = [(light * a).sum() / light.sum() for a in (x, y)]
        return [
            np.sqrt((light * (a - m) ** 2).sum() / light.sum())
            for a, m in zip((x, y), mean, strict=True)
        ]

    brushed, round_ = spread(STEEL), spread(replace(STEEL, anisotropy=0.0))
    truth = spread(STEEL, mode="reference", samples=128)
    assert brushed[0] > 1.2 * round_[0]
    assert brushed == pytest.approx(truth, rel=0.15)


def test_a_lamp_makes_a_streak():
    light = PunctualLight("point", (30.0, 30.0, 30.0), position=(0.0, 0.0, 3.0))
    parts = [Part(sheet(4.0, 4.0, 1, 1).turned(90, 0), 0)]
    scene = scene_of("plate", parts, [STEEL, GREY], lights=[light])
    lit, _ = shown(scene, constant_environment(0.0))
    middle = lit[24, 24, 0]
    # The sheet's u runs along x
    assert lit[24, 40, 0] > 0.1 * middle > 5 * lit[40, 24, 0]


def test_levels_that_only_brushed_surfaces_read_are_made_and_counted_once():
    sky = Environment(smooth_sky())

    def cost(material):
        frame = render(ball(material), sky, VIEW, {"aa": "none", "lens": "none"})
        return frame.statistics.environment

    first, second, third = cost(GREY), cost(STEEL), cost(STEEL)
    assert first.rebuilt and first.seconds > 0
    assert not second.rebuilt and second.seconds > 0
    assert not third.rebuilt and third.seconds == 0
