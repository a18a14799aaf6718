"""The sun as a disc."""

import numpy as np
import pytest

from raysvc.lighting.area_light import SunDisc
from raysvc.lighting.direct import reflected
from raysvc.lighting.sun import SunLight
from raysvc.tracing.tile_pattern import dealt_points
from tests.lighting.surfaces import random_directions, surface_of, views_of


def disc(direction, radius_deg):
    direction = np.asarray(direction, float) / np.linalg.norm(direction)
    return SunDisc(SunLight(tuple(direction.tolist()), (3.0, 2.0, 1.0), np.radians(radius_deg)))


@pytest.mark.parametrize("direction", [(0, 1, 0), (0, 0, 1), (0, 0, -1), (1, 2, 3), (-1, 0.1, 0)])
@pytest.mark.parametrize("radius_deg", [0.27, 5.0])
def test_rays_are_spread_evenly_over_the_disc(rng, direction, radius_deg):
    samples = dealt_points(7).reshape(-1, 2)
    surface = surface_of(random_directions(rng, 64), [0, 0, 1])
    rays = disc(direction, radius_deg).rays(surface, np.arange(64), samples)
    towards = np.asarray(direction, float) / np.linalg.norm(direction)
    d = rays.directions.astype(float)
    assert np.linalg.norm(d, axis=1) == pytest.approx(np.ones(64), abs=1e-6)
    assert np.isinf(rays.distance).all()
    # In the plane across, offsets have a mean of 0 and half of the squared radius.
    across = d - (d @ towards)[:, None] * towards
    radius = np.sin(np.radians(radius_deg))
    assert np.linalg.norm(across, axis=1).max() <= radius * 1.0001 + 1e-6
    assert np.linalg.norm(across.mean(axis=0)) < 0.05 * radius
    assert (across**2).sum(axis=1).mean() == pytest.approx(radius**2 / 2, rel=0.02)


def test_unshadowed_it_is_the_sun(rng):
    normal = random_directions(rng, 40)
    surface = surface_of(normal, views_of(rng, normal), 0.7, 0.2, 0.4)
    sun = disc((0, 1, 0), 0.5)
    expected = reflected(
        surface,
        np.tile(np.array([0, 1, 0], "f4"), (40, 1)),
        np.tile(np.array([3, 2, 1], "f4"), (40, 1)),
        np.radians(0.5),
    )
    assert sun.unshadowed(surface) == pytest.approx(expected)
