"""What points mirror: bounces between mirrors in closed form, where rays end, rough floors."""

import numpy as np
import pytest

import raysvc
from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import box, sheet, sphere
from raysvc.frame import shared_rays
from raysvc.scene import Material
from tests.frame.subjects import constant_environment

PLAIN = {"aa": "none", "occlusion_samples": 0, "shadows": False}


def mirror(reflectance: float) -> Material:
    """Every direction reflects the same: metal has no angle at which Fresnel adds nothing, so the
    view is along the normal."""
    return Material(
        base_colour=(reflectance,) * 3 + (1.0,), metallic=1.0, roughness=0.0, double_sided=True
    )


def between_mirrors(reflectance: float, glow: float):
    """A camera that looks straight at a mirror, with a glowing mirror behind itself."""
    glowing = Material(
        base_colour=(reflectance,) * 3 + (1.0,),
        metallic=1.0,
        roughness=0.0,
        emissive=(glow,) * 3,
        double_sided=True,
    )
    wall = sheet(40.0, 40.0, 1, 1).turned(90, 0)
    return scene_of(
        "between mirrors",
        [Part(wall.moved([0, 20, -2]), 0), Part(wall.moved([0, 20, 2]), 1)],
        [mirror(reflectance), glowing],
    )


@pytest.mark.parametrize("bounces", [1, 2, 3, 5, 8])
def test_light_between_two_mirrors_is_a_geometric_series(bounces: int) -> None:
    reflectance, glow = 0.8, 1.0
    view = {"eye": [0, 20, 0], "target": [0, 20, -2], "width": 3, "height": 3, "fov_y_deg": 1}
    frame = raysvc.render(
        between_mirrors(reflectance, glow),
        constant_environment(0.0),
        view,
        PLAIN | {"bounces": bounces},
    )
    # Bounce 1, 3, 5 ... meet the glowing mirror.
    expected = sum(reflectance**k * glow for k in range(1, bounces + 1, 2))
    assert frame.layers["beauty"][1, 1, 0] == pytest.approx(expected, rel=0.02)
    energies = [bounce.energy for bounce in frame.statistics.bounces]
    assert energies == pytest.approx(
        [reflectance**k * glow if k % 2 else 0.0 for k in range(1, bounces + 1)], rel=0.02, abs=1e-6
    )


def test_rays_that_can_add_nothing_are_not_followed() -> None:
    view = {"eye": [0, 20, 0], "target": [0, 20, -2], "width": 3, "height": 3, "fov_y_deg": 1}
    frame = raysvc.render(
        between_mirrors(0.1, 1.0), constant_environment(0.0), view, PLAIN | {"bounces": 8}
    )
    # 0.1^3 is below 1/256, so the third ray is not sent.
    assert [bounce.bounce for bounce in frame.statistics.bounces] == [1, 2]


def rough_floor(roughness: float):
    """A white post on a metal floor, in the dark; it is unlit, and no lamp."""
    floor = Material(base_colour=(0.9, 0.9, 0.9, 1.0), metallic=1.0, roughness=roughness)
    post = Material(base_colour=(1, 1, 1, 1), unlit=True)
    parts = [
        Part(sheet(20.0, 20.0, 1, 1), 0),
        Part(box(1.0, 6.0, 0.4).moved([0, 0, 0]), 1),
    ]
    return scene_of("post", parts, [floor, post])


VIEW = {"eye": [0, 2.0, 9], "target": [0, 0.0, 1.0], "width": 96, "height": 96, "fov_y_deg": 40}


def edge_width_px(row: np.ndarray) -> float:
    """Columns over which a row falls from 90 to 10 % of its greatest value, to the right."""
    row = row / row.max()
    middle = len(row) // 2
    right = row[middle:]
    return float(np.argmax(right < 0.1) - np.argmax(right < 0.9))


def test_a_rough_floor_shows_what_stands_on_it_softer_the_farther_it_is() -> None:
    settings = PLAIN | {"bounces": 1}
    beauty = raysvc.render(rough_floor(0.3), constant_environment(0.0), VIEW, settings).layers[
        "beauty"
    ][..., 0]
    sharp = raysvc.render(rough_floor(0.0), constant_environment(0.0), VIEW, settings).layers[
        "beauty"
    ][..., 0]
    ids = raysvc.render(rough_floor(0.3), constant_environment(0.0), VIEW, settings).layers[
        "object"
    ]
    foot = int(np.flatnonzero((ids == 1).any(axis=1)).max())
    near, far = foot + 3, 90
    assert edge_width_px(sharp[far]) <= 2
    assert edge_width_px(beauty[near]) <= 5
    assert edge_width_px(beauty[far]) >= 2 * max(edge_width_px(beauty[near]), 1.0)


def test_a_rough_reflection_has_no_noise() -> None:
    """Along the post's reflection neighbours differ by little."""
    beauty = raysvc.render(
        rough_floor(0.35), constant_environment(0.0), VIEW, PLAIN | {"bounces": 1}
    ).layers["beauty"][..., 0]
    stripe = beauty[75:92, 44:52]
    second = stripe[2:] - 2 * stripe[1:-1] + stripe[:-2]
    assert np.abs(second).mean() < 0.06 * stripe.mean()


def test_lobes_too_narrow_to_share_are_told_by_more_rays(monkeypatch: pytest.MonkeyPatch) -> None:
    """The post in a nearly smooth floor: with one ray a pixel its edges are grainy."""

    def shown(aa: str) -> np.ndarray:
        settings = PLAIN | {"bounces": 1, "aa": aa, "aa_samples": 32}
        frame = raysvc.render(rough_floor(0.12), constant_environment(0.0), VIEW, settings)
        frames.append(frame)
        return frame.layers["beauty"][60:, :, 0]

    frames: list[raysvc.Frame] = []
    truth, several, flagged = shown("full"), shown("none"), shown("edges")
    # Pixels on the floor are flagged, and shaded as in the truth.
    assert 0.01 < frames[2].layers["edge"][60:].mean() < 0.3
    monkeypatch.setattr(shared_rays, "LEAST_DIFFERENCE", np.inf)
    one = shown("none")
    assert frames[1].statistics.rays["reflection"] > frames[3].statistics.rays["reflection"]
    error = [float(np.square(picture - truth).mean()) for picture in (flagged, several, one)]
    assert error[0] < 0.3 * error[1] and error[1] < 0.7 * error[2]


def test_a_constant_world_is_reflected_as_constant() -> None:
    """Inside a glowing box everything that a lobe can see is 1, met or not."""
    ball = Material(base_colour=(1.0, 1.0, 1.0, 1.0), metallic=1.0, roughness=0.3)
    wall = Material(
        base_colour=(0, 0, 0, 1), metallic=0.0, emissive=(1.0,) * 3, unlit=False, double_sided=True
    )
    scene = scene_of(
        "ball in a box",
        [Part(sphere(0.5, 32), 0), Part(box(6.0, 6.0, 6.0).moved([0, -3, 0]), 1)],
        [ball, wall],
    )
    view = {"eye": [0, 0, 2.5], "target": [0, 0, 0], "width": 48, "height": 48, "fov_y_deg": 20}
    dark = constant_environment(0.0)
    met = raysvc.render(scene, dark, view, PLAIN | {"bounces": 1}).layers["beauty"]
    free = raysvc.render(
        scene_of("ball", [Part(sphere(0.5, 32), 0)], [ball]),
        constant_environment(1.0),
        view,
        PLAIN | {"bounces": 1},
    ).layers
    inside = free["id"] >= 0
    np.testing.assert_allclose(met[inside][:, :3], free["beauty"][inside][:, :3], rtol=0.03)
