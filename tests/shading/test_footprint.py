"""What pixels cover, from metres on a triangle to texels."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from raysvc.scene import Material, Texture, TextureRef
from raysvc.shading.footprint import Footprint
from raysvc.shading.footprint_kernels import spread_of_weights
from tests.oracles import texture as slow
from tests.scenes import chequered, quad
from tests.shading.filtering import Reader, random_texels
from tests.shading.reading import at_uv, parallelograms

SEEDS = st.integers(0, 2**32 - 1)


def as_is(vector):
    return tuple(float(x) for x in vector)


def random_triangle(rng):
    corners = rng.normal(size=(3, 3))
    across = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    assume(np.linalg.norm(across) > 0.2)
    normal = across / np.linalg.norm(across)
    direction = rng.normal(size=3)
    direction /= np.linalg.norm(direction)
    assume(abs(direction @ normal) > 0.1)
    return corners, normal, direction


def weights_of(corners, steps):
    """Changes of the weights of the second and third corner (2, ...) by steps in the plane."""
    edges = np.stack([corners[1] - corners[0], corners[2] - corners[0]], axis=1)
    return np.linalg.lstsq(edges, steps, rcond=None)[0]


@settings(deadline=None, max_examples=50)
@given(SEEDS)
def test_steps_on_a_triangle_become_steps_of_weights(seed):
    rng = np.random.default_rng(seed)
    corners, normal, direction = random_triangle(rng)
    steps = rng.normal(size=(3, 2))
    steps -= normal[:, None] * (normal @ steps)
    spread = spread_of_weights(
        *(as_is(corner) for corner in corners), as_is(direction), *map(as_is, steps.T), 0.0
    )
    moved = weights_of(corners, steps)
    expected = moved @ moved.T
    assert spread == pytest.approx((expected[0, 0], expected[0, 1], expected[1, 1]))


@settings(deadline=None, max_examples=30)
@given(SEEDS, st.floats(0.01, 2.0))
def test_a_blur_is_a_disc_across_the_ray_seen_on_the_triangle(seed, radius):
    rng = np.random.default_rng(seed)
    corners, normal, direction = random_triangle(rng)
    # Points of the disc, evenly spread, carried along the ray to the plane
    k = np.arange(4000)
    turn, out = k * np.pi * (3 - np.sqrt(5)), radius * np.sqrt((k + 0.5) / 4000)
    side = np.cross(direction, [1.0, 0, 0] if abs(direction[0]) < 0.9 else [0, 1.0, 0])
    side /= np.linalg.norm(side)
    points = np.outer(side, out * np.cos(turn)) + np.outer(
        np.cross(direction, side), out * np.sin(turn)
    )
    points -= np.outer(direction, normal @ points / (direction @ normal))
    moved = weights_of(corners, points)
    variance = moved @ moved.T / 4000
    nothing = (0.0, 0.0, 0.0)
    spread = spread_of_weights(
        *(as_is(corner) for corner in corners), as_is(direction), nothing, nothing, radius
    )
    expected = 12 * np.array([variance[0, 0], variance[0, 1], variance[1, 1]])
    assert spread == pytest.approx(expected, rel=5e-3, abs=2e-3 * expected[[0, 2]].max())


def test_a_triangle_without_area_is_covered_by_nothing():
    a, b = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)
    one = (1.0, 0.0, 0.0)
    assert spread_of_weights(a, b, b, one, one, one, 1.0) == (0, 0, 0)


@pytest.mark.parametrize("name", ["ewa", "sat", "mip"])
def test_slots_are_filtered_over_the_footprint_on_the_surface(rng, name):
    texels = random_texels(rng, 16, 16)
    # u'= 2 v, v' = -u: a quarter turn, twice as dense along one axis.
    ref = TextureRef(0, 0, (0, 2, 0, -1, 0, 0))
    scene = quad(Material(occlusion_texture=ref), textures=(Texture(texels),))
    read = Reader(texels)
    for u, v in rng.random((10, 2)):
        across, down = rng.uniform(-0.6, 0.6, (2, 2))
        footprint = parallelograms([*across, 0], [*down, 0])
        surface = at_uv(scene, [(u, v)], footprint=footprint, texture_filter=name)
        # The quad is 2 m wide and high; v grows downwards.
        steps = np.array([[across[0], down[0]], [-across[1], -down[1]]]) / 2
        steps = 16 * np.array([[0, 2], [-1, 0]]) @ steps
        expected = read(name, (2 * v, -u), steps)[0]
        assert surface.occlusion[0] == pytest.approx(expected, abs=2e-4)


def test_blur_is_added_to_the_pixels_own_footprint(rng):
    texels = random_texels(rng, 16, 16)
    scene = quad(Material(occlusion_texture=TextureRef(0)), textures=(Texture(texels),))
    footprint = parallelograms([0.3, 0, 0], [0, 0.2, 0], blur=0.4)
    surface = at_uv(scene, [(0.3, 0.6)], footprint=footprint, texture_filter="ewa")
    # A disc of radius r counts as a square of width r times the root of 3.
    width = np.sqrt(np.array([0.3, 0.2]) ** 2 + 3 * 0.4**2) / 2 * 16
    expected = Reader(texels)("ewa", (0.3, 0.6), np.diag(width))[0]
    assert surface.occlusion[0] == pytest.approx(expected, abs=2e-4)


@pytest.mark.parametrize("name", ["ewa", "sat"])
def test_squares_get_edges_as_wide_as_the_pixel(rng, name):
    texels = chequered([0, 255, 40], [100, 30, 220])
    reader = Reader(texels, ("clamp", "mirror"), nearest=True)
    for uv in rng.uniform(-0.2, 1.2, (40, 2)):
        wide, tall = rng.uniform(0.05, 0.7, 2)
        half = np.array([wide, tall]) / 2
        middle = uv * [3, 2]
        expected = slow.box_mean(texels, middle - half, middle + half, ("clamp", "mirror"), False)
        read = reader(name, uv, [[wide, 0], [0, tall]])
        assert read == pytest.approx(expected, abs=1e-6)


def test_footprints_of_points_have_no_extent():
    footprint = Footprint.points(3)
    assert [array.shape for array in footprint] == [(3, 3), (3, 3), (3,)]
    assert not any(array.any() for array in footprint)
