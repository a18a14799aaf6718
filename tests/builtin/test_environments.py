"""Built-in environments: the convention, exposure, and the sun's energy."""

import numpy as np
import pytest

from raysvc.builtin import BUILTIN_ENVIRONMENTS
from raysvc.builtin.clear_sky import LUMINANCE, SUN_DIRECTION, SUN_RADIUS_DEG, SUN_TO_SKY
from raysvc.builtin.lat_long import irradiance, texel_directions, texel_solid_angles
from raysvc.scene import Environment

UP = np.array([0.0, 1.0, 0.0])


@pytest.fixture(scope="module", params=sorted(BUILTIN_ENVIRONMENTS))
def environment(request: pytest.FixtureRequest) -> Environment:
    return BUILTIN_ENVIRONMENTS[request.param]()


def test_the_centre_looks_along_minus_z_with_plus_x_to_its_right_and_plus_y_on_top() -> None:
    height, width = 180, 360
    directions = texel_directions(height, width)
    near = np.pi / height
    ahead = directions[height // 2, width // 2]
    right = directions[height // 2, 3 * width // 4]
    left = directions[height // 2, width // 4]
    behind = directions[height // 2, 0]
    assert ahead == pytest.approx([0, 0, -1], abs=near)
    assert right == pytest.approx([1, 0, 0], abs=near)
    assert left == pytest.approx([-1, 0, 0], abs=near)
    assert behind == pytest.approx([0, 0, 1], abs=near)
    assert directions[0, 7] == pytest.approx([0, 1, 0], abs=near)
    assert directions[-1, 7] == pytest.approx([0, -1, 0], abs=near)
    # Half a texel right of the centre, exactly.
    assert ahead[0] == pytest.approx(np.sin(np.pi / width) * np.sin(np.pi * 90.5 / 180))


def test_texels_cover_the_sphere_once() -> None:
    assert (texel_solid_angles(16, 32) * 32).sum() == pytest.approx(4 * np.pi)


def test_a_uniform_map_gives_an_irradiance_of_pi(rng: np.random.Generator) -> None:
    facing = rng.normal(size=3)
    facing /= np.linalg.norm(facing)
    assert irradiance(np.ones((256, 512, 3)), facing) == pytest.approx(np.pi, rel=1e-3)


def test_a_middle_grey_surface_is_exposed_well(environment: Environment) -> None:
    radiance = environment.radiance.astype(np.float64)
    for facing in (UP, np.array([0.0, 0.0, 1.0]), np.array([-0.6, 0.8, 0.0])):
        radiosity = 0.18 * irradiance(radiance, facing) @ LUMINANCE / np.pi
        assert 0.1 < radiosity < 0.6


def test_environments_are_small_and_read_only(environment: Environment) -> None:
    height, width, _ = environment.radiance.shape
    assert width == 2 * height <= 1024
    assert not environment.radiance.flags.writeable


def test_the_brightest_texels_of_the_sky_are_the_sun() -> None:
    sky = BUILTIN_ENVIRONMENTS["clear_sky"]().radiance
    bright = sky[..., 1] > 100
    directions = texel_directions(*sky.shape[:2])[bright]
    angles = np.degrees(np.arccos(directions @ SUN_DIRECTION))
    assert np.linalg.norm(SUN_DIRECTION) == pytest.approx(1.0)
    assert angles.max() < SUN_RADIUS_DEG + 0.36
    assert 4 <= bright.sum() <= 24


def test_the_sun_gives_its_share_of_irradiance() -> None:
    radiance = BUILTIN_ENVIRONMENTS["clear_sky"]().radiance.astype(np.float64)
    sky = np.minimum(radiance, 100.0)
    from_sun = irradiance(radiance - sky, UP) @ LUMINANCE
    from_sky = irradiance(sky, UP) @ LUMINANCE
    assert from_sun / from_sky == pytest.approx(SUN_TO_SKY, rel=0.05)


def test_the_gradient_is_brighter_above() -> None:
    column = BUILTIN_ENVIRONMENTS["gradient"]().radiance[:, 0, 1]
    assert np.all(np.diff(column) < 0)


def test_the_key_light_of_the_studio_is_at_the_front_left() -> None:
    studio = BUILTIN_ENVIRONMENTS["studio"]().radiance.astype(np.float64)
    key = irradiance(studio, np.array([-0.7, 0.2, 0.7]))[1]
    assert key > 1.3 * irradiance(studio, np.array([0.7, 0.2, 0.7]))[1]
    assert key > 1.3 * irradiance(studio, np.array([-0.7, 0.2, -0.7]))[1]
