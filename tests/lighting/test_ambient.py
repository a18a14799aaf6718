"""What arrives from all around, against integrals over the hemisphere."""

import numpy as np
import pytest

from raysvc.lighting.ambient import Ambient, mean_of_rays
from raysvc.lighting.image_light import ImageLight
from raysvc.scene import Environment, Material
from raysvc.shading.scene_tables import SceneTables
from raysvc.tracing.occlusion import occlusion_rays, pattern
from raysvc.tracing.world import World
from tests.oracles.hemisphere import ambient as integrated
from tests.oracles.lobe import map_directions
from tests.scenes import mesh, quad
from tests.tracing.points import points

MANY = pattern(4096, seed=2)
WHITE = Material(metallic=0.0)


def constant(value=1.0):
    return Environment(np.full((16, 32, 3), value, np.float32))


def from_the_right(height=64):
    """Bright towards +X, smoothly dark towards -X."""
    directions, _ = map_directions(height, 2 * height)
    grey = np.repeat((1 + 0.95 * directions[:, :1]) ** 2, 3, axis=1)
    return Environment(grey.reshape(height, 2 * height, 3).astype(np.float32))


def wall(x, material=WHITE, half=1000.0):
    corners = [(x, -half, -half), (x, half, -half), (x, half, half), (x, -half, half)]
    return mesh(corners, [[0, 1, 2], [0, 2, 3]], materials=(material,))


def seen(scene, surface, environment, *, radius_m=1.0, patch=None, sent=None, samples=MANY):
    world = World(scene, SceneTables.of(scene), "auto")
    tile = np.zeros(surface.size, np.int32)
    rays = occlusion_rays(surface, tile, samples, radius_m)
    hits, through = world.hiding(rays)
    shape = surface.size, len(samples)
    patches = np.where(hits.triangle >= 0, -1 if patch is None else patch, -1).astype(np.int32)
    return mean_of_rays(
        ImageLight(environment).softened(0.05),
        rays.directions.reshape(*shape, 3),
        through.reshape(shape),
        patches.reshape(shape),
        np.zeros((0, 3), "f4") if sent is None else np.asarray(sent, np.float32),
    )


def test_where_nothing_hides_anything_all_arrives(rng):
    at = np.concatenate([rng.uniform(-40, 40, (50, 2)), np.zeros((50, 1))], axis=1)
    surface = points(at, (0, 0, 1))
    found = seen(quad(half=50.0), surface, from_the_right(), samples=pattern(16, 0))
    assert (found.visible == 1).all() and found.sky == pytest.approx(np.ones((50, 3)))
    assert not found.bounced.any()
    assert not found.hidden.any()
    assert found.bent_normal(surface.normal) == pytest.approx(surface.normal)
    for arrived, all_ in zip(found, Ambient.open(50), strict=True):
        assert arrived == pytest.approx(all_)


@pytest.mark.parametrize("distance", [0.05, 0.3, 0.8])
def test_under_constant_light_what_arrives_is_the_free_part(distance):
    found = seen(wall(distance), points([0, 0, 0], (0, 0, 1)), constant(7.0))
    assert found.sky == pytest.approx(np.repeat(found.visible[:, None], 3, axis=1), rel=1e-5)
    assert 0.4 < found.visible[0] < 1


@pytest.mark.parametrize("distance", [0.05, 0.3, 0.8])
@pytest.mark.parametrize("side", [1, -1])
def test_beside_a_wall_light_and_bent_normal_are_those_of_the_integral(distance, side):
    # A wall on the bright side takes most of the light, one on the dark side hardly any.
    surface = points([0, 0, 0], (0, 0, 1))
    found = seen(wall(side * distance), surface, from_the_right())
    free, bent, sky = integrated(
        (0, 0, 1),
        lambda d: side * d[:, 0] < distance,
        lambda d: (1 + 0.95 * d[:, 0]) ** 2,
    )
    assert found.visible[0] == pytest.approx(free, abs=0.004)
    assert found.hidden[0] == pytest.approx(np.array([0, 0, 2 / 3]) - bent, abs=0.004)
    expected = bent / np.linalg.norm(bent)
    assert found.bent_normal(surface.normal)[0] == pytest.approx(expected, abs=0.01)
    assert found.sky[0] == pytest.approx(np.full(3, sky), abs=0.008)
    assert (side > 0) == (sky < free)


def test_a_colour_that_the_environment_has_not_is_free_as_the_hemisphere_is():
    red = np.zeros((16, 32, 3), np.float32)
    red[..., 0] = 1
    found = seen(wall(0.3), points([0, 0, 0], (0, 0, 1)), Environment(red))
    assert found.sky[0] == pytest.approx(np.full(3, found.visible[0]), rel=1e-4)


def test_what_hides_the_environment_sends_its_own_light():
    found = seen(
        wall(0.3), points([0, 0, 0], (0, 0, 1)), constant(), patch=1, sent=[[9, 9, 9], [1, 2, 3]]
    )
    hidden = 1 - found.visible[0]
    assert found.bounced[0] == pytest.approx(hidden * np.array([1, 2, 3]), rel=1e-4)


def test_a_pane_sends_and_lets_through_its_parts():
    pane = Material(base_colour=(1, 1, 1, 0.25), alpha_mode="blend", metallic=0.0)
    found = seen(
        wall(1e-4, pane), points([0, 0, 0], (0, 0, 1)), constant(), patch=0, sent=[[1, 1, 1]]
    )
    assert found.visible[0] == pytest.approx(1 - 0.25 / 2, abs=0.003)
    assert found.bounced[0, 0] == pytest.approx(0.25 / 2, abs=0.003)


def test_columns_hold_all_of_it(rng):
    columns = rng.random((5, 10)).astype(np.float32)
    assert (Ambient.of_columns(columns).columns() == columns).all()


def test_a_hidden_point_has_no_bent_normal():
    normal = np.array([[0, 0, 1]], np.float32)
    hidden = Ambient.open(1)._replace(visible=np.zeros(1, "f4"), hidden=normal * np.float32(0.66))
    assert not hidden.bent_normal(normal).any()
