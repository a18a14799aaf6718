"""Six pictures around a point as a lat-long map."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from raysvc.lighting.cube_map import (
    DETAIL,
    FACES,
    face_cameras,
    lat_long_of_faces,
    pixel_half_width_rad,
)
from raysvc.lighting.lat_long import texel_directions, texel_solid_angles
from raysvc.parallel import Control
from tests.oracles.cube_map import lat_long, lookup


def pictures_of(radiance, size):
    """What face cameras see of radiance (N, 3) in directions (N, 3)."""
    faces = []
    for camera in face_cameras(np.zeros(3), size):
        _, directions = camera.rays(np.arange(camera.width * camera.height))
        faces.append(radiance(directions).reshape(camera.height, camera.width, 3))
    return np.stack(faces).astype(np.float32)


def test_faces_are_right_handed_views_that_cover_all_directions() -> None:
    for right, up, forward in FACES:
        np.testing.assert_array_equal(np.cross(right, up), -forward)
    assert sorted(map(tuple, FACES[:, 2])) == sorted(
        tuple(sign * axis) for axis in np.eye(3) for sign in (1, -1)
    )


@pytest.mark.parametrize("size", [2, 5])
def test_maps_are_those_of_the_slow_twin(size: int) -> None:
    rng = np.random.default_rng(size)
    pictures = rng.uniform(0, 10, (6, size + 2, size + 2, 3)).astype(np.float32)
    np.testing.assert_allclose(
        lat_long_of_faces(pictures, Control()), lat_long(pictures, FACES, DETAIL), rtol=1e-5
    )


def test_a_texel_shows_what_is_in_its_direction() -> None:
    def radiance(directions):
        return 1.0 + directions + directions[:, [1, 2, 0]] ** 2

    size = 32
    shown = lat_long_of_faces(pictures_of(radiance, size), Control())
    rows, columns = np.mgrid[: 2 * size, : 4 * size] + 0.5
    directions = texel_directions(rows, columns, 2 * size, 4 * size)
    wanted = radiance(directions.reshape(-1, 3)).reshape(shown.shape)
    np.testing.assert_allclose(shown, wanted, atol=3e-3)


def test_constant_light_stays_constant() -> None:
    pictures = np.full((6, 18, 18, 3), 0.7, np.float32)
    np.testing.assert_allclose(lat_long_of_faces(pictures, Control()), 0.7, rtol=1e-6)


def test_light_of_small_spots_is_kept() -> None:
    size = 24
    towards = np.random.default_rng(3).normal(size=(40, 3))
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)

    def radiance(directions):
        near = np.exp(40.0 * (directions @ towards.T - 1.0)).sum(axis=1)
        return np.repeat(near[:, None], 3, axis=1)

    shown = lat_long_of_faces(pictures_of(radiance, size), Control())
    light = shown[..., 0].sum(axis=1) @ texel_solid_angles(2 * size, 4 * size)
    # The integral of exp(k (cos - 1)) over the sphere
    wanted = len(towards) * 2 * np.pi * (1 - np.exp(-80.0)) / 40.0
    assert light == pytest.approx(wanted, rel=2e-3)


@given(
    st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: np.linalg.norm(v) > 0.1),
    st.integers(0, 2),
)
def test_there_is_no_seam_between_faces(direction, axis) -> None:
    # On a border two faces are equally near, and both must say the same
    direction = np.array(direction)
    other = (axis + 1) % 3
    direction[other] = direction[axis] = max(np.abs(direction))
    direction /= np.linalg.norm(direction)
    pictures = pictures_of(lambda d: 1.0 + d * d[:, [2, 0, 1]], 8)
    step = np.zeros(3)
    step[axis] = 1e-6
    one, two = (lookup(pictures, FACES, direction + side * step) for side in (1, -1))
    np.testing.assert_allclose(one, two, atol=0.02)


def test_the_map_does_not_depend_on_threads() -> None:
    pictures = np.random.default_rng(0).uniform(size=(6, 34, 34, 3)).astype(np.float32)
    one, many = (lat_long_of_faces(pictures, Control(threads)) for threads in (1, 3))
    np.testing.assert_array_equal(one, many)


def test_a_pixel_in_the_middle_covers_its_solid_angle() -> None:
    assert np.pi * pixel_half_width_rad(100) ** 2 == pytest.approx((2 / 100) ** 2)
