"""Rays into the specular lobe: their mean is the lobe's albedo, their density the formula's."""

import numpy as np
import pytest

from raysvc.lighting.albedo import specular_albedo
from raysvc.lighting.lobe_kernels import lobe_rays
from raysvc.tracing.tile_pattern import tile_points
from tests.lighting.surfaces import surface_of

UP = np.array([0.0, 1.0, 0.0])


def sampled(nov, roughness, samples, **material):
    normal = np.tile(UP, (len(samples), 1))
    view = np.tile([np.sqrt(1 - nov**2), nov, 0.0], (len(samples), 1))
    surface = surface_of(normal, view, roughness=roughness, **material)
    directions = np.empty((len(samples), 3), np.float32)
    weight, half_width = np.empty((2, len(samples)), np.float32)
    lobe_rays(surface, samples, directions, weight, half_width)
    return surface, directions, weight, half_width


def fine_lattice(count=4096):
    index = np.arange(count)
    return np.stack([(index * 0.6180339887498949) % 1.0, (index + 0.5) / count], axis=1)


@pytest.mark.parametrize("nov", [1.0, 0.6, 0.2])
@pytest.mark.parametrize("roughness", [0.1, 0.4, 0.8])
@pytest.mark.parametrize("metallic", [0.0, 1.0])
def test_the_mean_weight_is_the_albedo(nov, roughness, metallic):
    surface, _, weight, _ = sampled(
        nov, roughness, fine_lattice(), metallic=metallic, base=(0.6, 0.6, 0.6)
    )
    expected = specular_albedo(surface.rows(0, 1))[0, 0]
    assert weight.mean() == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("nov", [1.0, 0.5])
@pytest.mark.parametrize("roughness", [0.1, 0.3, 0.7])
def test_cones_of_all_rays_add_up_to_the_solid_angle_that_they_cover(nov, roughness):
    """The mean of 1 / density over the samples of a region is the region's solid angle."""
    _, directions, weight, half_width = sampled(nov, roughness, fine_lattice(1 << 15))
    mirror = np.array([-np.sqrt(1 - nov**2), nov, 0.0])
    limit = np.cos(min(2 * roughness**2, 0.5))
    inside = (directions @ mirror > limit) & (weight > 0)
    covered = (np.pi * half_width[inside].astype(float) ** 2).sum() / len(half_width)
    above = np.arccos(limit) < np.arcsin(nov)
    assert above and inside.mean() > 0.02
    assert covered == pytest.approx(2 * np.pi * (1 - limit), rel=0.03)


def test_a_mirror_sends_all_rays_the_same_way():
    _, directions, weight, half_width = sampled(0.6, 0.0, tile_points(0))
    assert directions == pytest.approx(np.tile([-0.8, 0.6, 0.0], (64, 1)), abs=1e-6)
    assert (weight == 1).all() and (half_width == 0).all()


def test_no_ray_goes_below_the_triangle():
    normal = np.tile(UP, (64, 1))
    view = np.tile([0.995, 0.0998, 0.0], (64, 1))
    surface = surface_of(normal, view, roughness=0.9)
    tilted = np.tile([0.6, 0.8, 0.0], (64, 1)).astype(np.float32)
    surface = surface._replace(geometric_normal=tilted)
    directions = np.empty((64, 3), np.float32)
    weight, half_width = np.empty((2, 64), np.float32)
    lobe_rays(surface, tile_points(3), directions, weight, half_width)
    assert (directions @ tilted[0] >= -1e-6).all()
    assert (weight == 0).any() and (weight > 0).any()
    assert np.linalg.norm(directions, axis=1) == pytest.approx(np.ones(64), abs=1e-5)
