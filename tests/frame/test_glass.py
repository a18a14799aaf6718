"""Pictures of glass: furnaces, what is behind, shadows, varnish."""

import numpy as np
import pytest

import raysvc
from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import box, sheet, sphere
from raysvc.scene import Environment, Material, PunctualLight
from tests.frame.subjects import ball, constant_environment

PLAIN = {"aa": "none", "occlusion_samples": 0}
FRONT = {"eye": [0.0, 0.0, 4.0], "target": [0.0, 0.0, 0.0], "width": 48, "height": 48}


def solid(**changes: object) -> Material:
    values = {"metallic": 0.0, "roughness": 0.0, "transmission": 1.0, "solid": True} | changes
    return Material(**values)  # type: ignore[arg-type]


def thin(**changes: object) -> Material:
    return solid(solid=False, double_sided=True, **changes)


@pytest.mark.parametrize("ior", [1.1, 1.5, 2.0])
def test_a_glass_ball_in_a_furnace_is_not_seen(ior: float) -> None:
    """Clear glass under constant light neither adds nor takes; at most paths are cut off."""
    frame = raysvc.render(
        ball(solid(ior=ior), 64), constant_environment(), FRONT, PLAIN | {"bounces": 4}
    )
    shown = frame.layers["beauty"][frame.layers["id"] >= 0][:, :3]
    middle = np.median(shown)
    assert middle == pytest.approx(1.0, abs=0.01)
    assert shown.mean() == pytest.approx(1.0, abs=0.03)


@pytest.mark.parametrize("roughness", [0.0, 0.3])
def test_a_thin_pane_in_a_furnace_is_not_seen(roughness: float) -> None:
    pane = scene_of("pane", [Part(sheet(9, 9, 1, 1).turned(90, 0), 0)], [thin(roughness=roughness)])
    frame = raysvc.render(pane, constant_environment(), FRONT, PLAIN)
    assert frame.layers["beauty"][..., :3] == pytest.approx(1.0, abs=0.02)


def top_and_bottom() -> Environment:
    radiance = np.zeros((32, 64, 3), np.float32)
    radiance[:16, :, 0] = 1.0
    radiance[16:, :, 2] = 1.0
    return Environment(radiance)


def test_a_glass_ball_turns_what_is_behind_it_over_and_a_bubble_does_not() -> None:
    pictures = {}
    for name, material in (("ball", solid(ior=1.5)), ("bubble", thin(ior=1.5))):
        frame = raysvc.render(ball(material, 64), top_and_bottom(), FRONT, PLAIN)
        pictures[name] = frame.layers["beauty"]
    upper, lower = pictures["ball"][18, 24], pictures["ball"][29, 24]
    assert upper[2] > 0.8 > 0.2 > upper[0] and lower[0] > 0.8 > 0.2 > lower[2]
    upper, lower = pictures["bubble"][18, 24], pictures["bubble"][29, 24]
    assert upper[0] > 0.8 > 0.2 > upper[2] and lower[2] > 0.8 > 0.2 > lower[0]


def test_absorption_is_that_of_the_way_through() -> None:
    """Straight through a slab: exp(-a d) of what two boundaries let through, seen along the
    normal."""
    depth, absorption = 0.8, 0.7
    slab = scene_of(
        "slab",
        [Part(box(9.0, 9.0, depth).moved([0, -4.5, 0]), 0)],
        [solid(ior=1.5, absorption=(absorption,) * 3)],
    )
    view = FRONT | {"width": 3, "height": 3, "fov_y_deg": 1.0}
    frame = raysvc.render(slab, constant_environment(), view, PLAIN | {"bounces": 8})
    f0, left = 0.04, np.exp(-absorption * depth)
    expected = f0 + (1 - f0) ** 2 * left / (1 - f0 * left)
    assert frame.layers["beauty"][1, 1, :3] == pytest.approx(expected, rel=0.01)


def test_frosted_glass_blurs_what_is_far_behind_it_without_noise() -> None:
    wall = Material(base_colour=(0, 0, 0, 1), metallic=0.0, emissive=(1.0, 1.0, 1.0))

    def shown(roughness: float) -> np.ndarray:
        scene = scene_of(
            "window",
            [
                Part(sheet(9, 9, 1, 1).turned(90, 0), 0),
                Part(box(2.0, 9.0, 0.1).moved([0, -4.5, -2.0]), 1),
            ],
            [thin(roughness=roughness), wall],
        )
        return raysvc.render(scene, constant_environment(0.0), FRONT, PLAIN).layers["beauty"][
            ..., 0
        ]

    sharp, blurred = shown(0.0), shown(0.35)
    assert np.abs(np.diff(sharp[24])).max() > 0.8
    assert np.abs(np.diff(blurred[24])).max() < 0.2
    # Rows are alike: what differs between them is noise.
    assert blurred[16:32].std(axis=0).max() < 0.05
    # Light is spread over a wider strip, some of it beyond the picture's edges.
    assert 0.6 * sharp.mean() < blurred.mean() < sharp.mean()


def test_glass_throws_a_faint_shadow_and_only_in_proportion_to_its_tint() -> None:
    lamp = PunctualLight("directional", (3.0, 3.0, 3.0), direction=(0.0, -1.0, 0.0))

    def lit(material: Material) -> float:
        scene = scene_of(
            "shade",
            [
                Part(sheet(6, 6, 1, 1), 0),
                Part(sheet(2, 2, 1, 1).moved([0, 1.5, 0]), 1),
            ],
            [Material(metallic=0.0, roughness=1.0), material],
            lights=[lamp],
        )
        view = {"eye": [0, 1, 3], "target": [0, 0, 0], "width": 9, "height": 9, "fov_y_deg": 3.0}
        return float(
            raysvc.render(scene, constant_environment(0.0), view, PLAIN).layers["beauty"][4, 4, 1]
        )

    open_ = lit(Material(base_colour=(1, 1, 1, 0.0), alpha_mode="blend", metallic=0.0))
    assert lit(thin()) == pytest.approx(0.96 * open_, rel=1e-3)
    assert lit(thin(base_colour=(0.5, 0.5, 0.5, 1.0))) == pytest.approx(0.48 * open_, rel=1e-3)
    assert lit(Material(metallic=0.0, double_sided=True)) == 0.0


def test_varnish_mirrors_the_scene_and_not_the_environment_behind_it() -> None:
    """A black ball with a coat before a glowing wall, in a world of another colour."""
    coat = Material(base_colour=(0, 0, 0, 1), metallic=0.0, roughness=1.0, ior=1.0, clearcoat=1.0)
    glow = Material(base_colour=(0, 0, 0, 1), metallic=0.0, emissive=(5.0, 0.0, 0.0))
    radiance = np.zeros((16, 32, 3), np.float32)
    radiance[..., 2] = 5.0
    scene = scene_of(
        "coat",
        [Part(sphere(1.0, 48), 0), Part(box(60.0, 60.0, 0.1).moved([0, -30, 8.0]), 1)],
        [coat, glow],
    )
    frames = {
        bounces: raysvc.render(scene, Environment(radiance), FRONT, PLAIN | {"bounces": bounces})
        for bounces in (0, 1)
    }
    environment, mirrored = (frames[b].layers["beauty"][24, 24] for b in (0, 1))
    assert environment[0] < 0.01 < 0.15 < environment[2]
    assert mirrored[0] == pytest.approx(0.04 * 5.0, rel=0.1) and mirrored[2] < 0.02


def test_glass_looks_the_same_with_any_number_of_threads() -> None:
    scene = raysvc.load("builtin:glass")
    view = {"gltf_camera": 0, "width": 48, "height": 27}
    frames = [
        raysvc.render(scene, camera=view, settings={"threads": threads, "aa_samples": 2})
        for threads in (1, 3)
    ]
    assert frames[0].encode("exr") == frames[1].encode("exr")
    assert frames[0].statistics.rays["refraction"] > 0
