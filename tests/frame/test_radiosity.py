"""Light that goes back and forth: geometric series in closed rooms, and what leaves open ones."""

import numpy as np
import pytest

import raysvc
from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import box, sheet, sphere
from raysvc.frame.prepared import prepare
from raysvc.frame.radiance import Illumination
from raysvc.frame.settings import Settings
from raysvc.frame.statistics import Ledger
from raysvc.parallel import Control
from raysvc.scene import Material, PunctualLight
from tests.frame.subjects import constant_environment


def matt(albedo, emissive=0.0, **more):
    return Material(
        base_colour=(albedo,) * 3 + (1.0,),
        metallic=0.0,
        roughness=1.0,
        emissive=(emissive,) * 3,
        **more,
    )


def room(material):
    """A closed box of 2 m about the origin, seen from inside."""
    return scene_of("room", [Part(box(2.0, 2.0, 2.0).moved([0, -1, 0]), 0)], [material])


def sent(scene, environment, **settings):
    """Radiance (P, 3) of the patches, and the patches."""
    chosen = Settings(**settings)
    prepared = prepare(scene, environment, chosen)
    illumination = Illumination(prepared, chosen, 1e3, Ledger())
    illumination.settle(Control(threads=1))
    return illumination._sent, prepared.patches


def albedo_of(material, environment=1.0):
    """What a matt convex ball of the material shows on the mean under light of 1."""
    ball = scene_of("ball", [Part(sphere(1.0, 24), 0)], [material])
    return sent(ball, constant_environment(environment))[0].mean()


@pytest.mark.parametrize("albedo", [0.2, 0.5, 0.8])
def test_a_convex_body_under_constant_light_sends_its_albedo(albedo: float) -> None:
    ball = scene_of("ball", [Part(sphere(1.0, 24), 0)], [matt(albedo)])
    radiance, _ = sent(ball, constant_environment(2.0))
    assert radiance == pytest.approx(np.full_like(radiance, radiance.mean()), rel=0.01)
    # The dielectric's own reflection is added to the base, and takes its share from it.
    assert 2 * albedo * 0.93 < radiance.mean() < 2 * (albedo + 0.05)


@pytest.mark.parametrize("albedo", [0.2, 0.5, 0.8])
def test_a_closed_glowing_room_is_a_geometric_series(albedo: float) -> None:
    glowing = matt(albedo, emissive=1.0, double_sided=True)
    radiance, patches = sent(room(glowing), constant_environment(0.0))
    inside = np.einsum("pk,pk->p", patches.towards[::4], _middles(patches)) < 0
    expected = 1.0 / (1.0 - albedo_of(matt(albedo)))
    assert radiance[inside] == pytest.approx(np.full((inside.sum(), 3), expected), rel=0.03)
    # The outside sees nothing but the dark.
    assert radiance[~inside] == pytest.approx(np.ones(((~inside).sum(), 3)))


def _middles(patches):
    corners = patches.positions[patches.triangles[patches.triangle[::4]]]
    u, v = patches.barycentric[::4].T
    weights = np.stack([1 - u - v, u, v], axis=1)
    return np.einsum("pk,pkc->pc", weights, corners)


def test_a_picture_of_that_room_shows_the_series() -> None:
    view = {"eye": [0, 0, 0.9], "target": [0, 0, -1], "width": 32, "height": 32, "fov_y_deg": 60}
    glowing = matt(0.5, emissive=1.0, double_sided=True)
    frame = raysvc.render(room(glowing), constant_environment(0.0), view, {"bounces": 0})
    expected = 1.0 / (1.0 - albedo_of(matt(0.5)))
    shown = frame.layers["beauty"][..., :3]
    assert shown.mean() == pytest.approx(expected, rel=0.03)
    assert shown.std() < 0.03 * expected
    assert frame.layers["occlusion"].max() < 0.01


def test_light_of_a_lamp_comes_back_from_the_floor() -> None:
    """A ceiling that no lamp shines on shows what the floor below it returns of one."""
    floor, ceiling = matt(0.5), matt(0.8, double_sided=True)
    light = PunctualLight("directional", (np.pi, np.pi, np.pi), direction=(0.0, -1.0, 0.0))
    parts = [Part(sheet(40.0, 40.0, 8, 8), 0), Part(sheet(0.02, 0.02, 1, 1).moved([0, 0.5, 0]), 1)]
    scene = scene_of("lid", parts, [floor, ceiling], lights=[light])
    view = {"eye": [0, 0.3, 0.0], "target": [0, 0.5, 0], "up": [0, 0, 1], "fov_y_deg": 3}
    frame = raysvc.render(
        scene, constant_environment(0.0), view | {"width": 16, "height": 16}, {"bounces": 0}
    )
    shown = frame.layers["beauty"][4:12, 4:12, :3].mean()
    # The floor fills the ceiling's hemisphere but for its rim: radiance 0.5, returned by 0.8.
    assert shown == pytest.approx(0.5 * 0.8, rel=0.08)


def test_glow_of_unlit_things_is_seen_but_they_return_nothing() -> None:
    shown = matt(0.7, unlit=True)
    ball = scene_of("ball", [Part(sphere(1.0, 12), 0)], [shown])
    radiance, _ = sent(ball, constant_environment(5.0))
    assert radiance == pytest.approx(np.full_like(radiance, 0.7))


def test_without_occlusion_samples_nothing_goes_back_and_forth() -> None:
    radiance, patches = sent(room(matt(0.5, 1.0)), constant_environment(0.0), occlusion_samples=0)
    assert patches is None and len(radiance) == 0
