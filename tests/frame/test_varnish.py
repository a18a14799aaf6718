"""Varnish in whole frames."""

import math
from dataclasses import replace

import numpy as np
import pytest

import raysvc
from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import sheet, sphere
from raysvc.scene import Material, PunctualLight, Scene
from tests.frame.subjects import MIRROR, ball, constant_environment
from tests.oracles.directional_albedo import directional_albedo

PLAIN = {"aa": "none", "occlusion_samples": 0, "bounces": 0}
FRONT = {"eye": [0.0, 0.0, 4.0], "target": [0.0, 0.0, 0.0], "width": 48, "height": 48}
PAINT = {"base_colour": (0.6, 0.1, 0.05, 1.0), "metallic": 0.5, "roughness": 0.6}


def varnished(**changes) -> Scene:
    return ball(Material(**{**PAINT, "clearcoat": 1.0, "clearcoat_roughness": 0.1, **changes}))


def ring(frame: raysvc.Frame, near: float) -> tuple[float, np.ndarray]:
    """Mean cosine and colour of the pixels that see the ball at about a cosine."""
    rows, cols = np.nonzero(frame.layers["id"] >= 0)
    tan = math.tan(math.radians(20))
    towards = np.stack([(cols - 23.5) / 24 * tan, (23.5 - rows) / 24 * tan, -np.ones(len(rows))], 1)
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    cosine = -np.einsum("nk,nk->n", towards, frame.layers["normal"][rows, cols])
    chosen = np.abs(cosine - near) < 0.02
    shown = frame.layers["beauty"][rows, cols][chosen][:, :3].mean(axis=0)
    return float(cosine[chosen].mean()), shown


@pytest.mark.parametrize("strength", [1.0, 0.4])
def test_a_varnished_ball_under_constant_light_shows_both_albedos(strength: float) -> None:
    frame = raysvc.render(varnished(clearcoat=strength), constant_environment(), FRONT, PLAIN)
    for near in (0.9, 0.6, 0.35):
        cosine, shown = ring(frame, near)
        base = directional_albedo(cosine, PAINT["base_colour"][:3], 0.5, 0.6)
        coat = directional_albedo(cosine, (1.0, 1.0, 1.0), 1.0, 0.1)
        share = strength * (0.04 + 0.96 * (1 - cosine) ** 5)
        np.testing.assert_allclose(shown, base + share * (coat - base), rtol=0.01)


def test_varnish_darkens_what_glows_underneath() -> None:
    glowing = varnished(emissive=(2.0, 2.0, 2.0))
    frame = raysvc.render(glowing, constant_environment(0.0), FRONT, PLAIN)
    for near in (0.9, 0.35):
        cosine, shown = ring(frame, near)
        share = 0.04 + 0.96 * (1 - cosine) ** 5
        np.testing.assert_allclose(shown, 2 * (1 - share), rtol=5e-3)


def test_a_lamp_has_a_small_bright_highlight_on_varnish() -> None:
    lamp = PunctualLight("directional", (1.0, 1.0, 1.0), direction=(0.0, 0.0, -1.0))
    frames = []
    for clearcoat in (0.0, 1.0):
        scene = varnished(clearcoat=clearcoat, clearcoat_roughness=0.2)
        scene = replace(scene, lights=(lamp,))
        frames.append(raysvc.render(scene, constant_environment(0.0), FRONT, PLAIN))
    bare, coated = (frame.layers["beauty"][..., :3].sum(axis=-1) for frame in frames)
    brighter = coated > 1.02 * bare
    assert coated.max() > 3 * bare.max()
    assert 0 < brighter.sum() < 0.1 * (bare > 0).sum()
    aside = np.hypot(*(np.indices(bare.shape) - 23.5)) > 9
    assert (coated <= bare)[aside].all(), "elsewhere the base is darker by the coat's share"


def test_varnish_is_seen_in_a_mirror_too() -> None:
    """The darkest that a mirror shows is a black ball beside the camera."""
    black = Material(base_colour=(0.0, 0.0, 0.0, 1.0), metallic=0.0, roughness=1.0)
    darkest = []
    for clearcoat in (0.0, 1.0):
        parts = [
            Part(sheet(8.0, 8.0, 1, 1).turned(90, 0).moved([0.0, 0.0, -2.0]), 0),
            Part(sphere(1.0, 24).moved([2.2, 0.0, 4.0]), 1),
        ]
        scene = scene_of("mirror", parts, [MIRROR, replace(black, clearcoat=clearcoat)])
        frame = raysvc.render(scene, constant_environment(), FRONT, PLAIN | {"bounces": 1})
        assert (frame.layers["object"] != 1).all()
        in_mirror = frame.layers["object"] == 0
        darkest.append(frame.layers["beauty"][in_mirror][:, 0].min())
    assert darkest[0] < 0.03
    assert darkest[1] - darkest[0] == pytest.approx(0.04, abs=0.01)
