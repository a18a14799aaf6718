"""Paths through glass: every part of it together, in furnaces and against closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest

from raysvc.accel.base import Rays
from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import box, sheet, sphere
from raysvc.geometry.basis_kernels import basis
from raysvc.geometry.vector_kernels import dot, plus, row3, scaled
from raysvc.jit import kernel
from raysvc.lighting.brdf import ggx_alpha, visible_normal
from raysvc.lighting.microfacet_reflection import reflection_sample
from raysvc.lighting.microfacet_refraction import boundary_fresnel_weight, refraction_sample
from raysvc.lighting.thin_transmission import thin_sample
from raysvc.scene import Material
from raysvc.shading.scene_tables import SceneTables
from raysvc.tracing.reflection import rays_from
from raysvc.tracing.world import World
from tests.lighting.surfaces import random_directions

GLASS = Material(metallic=0.0, roughness=0.0, transmission=1.0, solid=True)


@kernel
def scatter(surface, numbers, throughput, directions, goes_on):
    """Reflect or let through, as often as Fresnel's term says; nothing is diffused."""
    for i in range(len(numbers)):
        normal, view = row3(surface.normal, i), row3(surface.to_viewer, i)
        tangent, bitangent = basis(normal)
        local = (dot(view, tangent), dot(view, bitangent), dot(view, normal))
        alpha = ggx_alpha(np.float64(surface.roughness[i]))
        ior = np.float64(surface.glass.ior[i])
        eta = 1.0
        if surface.glass.solid[i]:
            eta = 1.0 / ior if surface.glass.entering[i] else ior
        turn, u = 2.0 * math.pi * numbers[i, 0], numbers[i, 1]
        c, s = math.cos(turn), math.sin(turn)
        h = visible_normal(local, alpha, c, s, u)
        f0 = np.float64(surface.dielectric_f0[i])
        weight = boundary_fresnel_weight(local[0] * h[0] + local[1] * h[1] + local[2] * h[2], eta)
        through = numbers[i, 2] >= f0 * (1.0 - weight) + weight
        if not through:
            light, share, _ = reflection_sample(local, alpha, c, s, u)
        elif surface.glass.solid[i]:
            light, share, _ = refraction_sample(local, eta, alpha, c, s, u)
        else:
            light, share, _ = thin_sample(local, alpha, c, s, u)
        towards = plus(plus(scaled(tangent, light[0]), bitangent, light[1]), normal, light[2])
        above = dot(towards, row3(surface.geometric_normal, i))
        goes_on[i] = share > 0.0 and (above < 0.0) == through
        for k in range(3):
            directions[i, k] = towards[k]
            throughput[i, k] *= share
            if through:
                throughput[i, k] *= surface.base_colour[i, k]


def seen(scene, origins, directions, rng, bounces=60):
    """What each of R rays shows under light that is 1 from everywhere, (R, 3): one path each."""
    tables = SceneTables.of(scene)
    world = World(scene, tables, "bvh")
    directions = np.ascontiguousarray(directions, np.float32)
    radiance = np.zeros((len(directions), 3))
    throughput = np.ones((len(directions), 3))
    path = np.arange(len(directions))
    rays = Rays(
        np.ascontiguousarray(origins, np.float32),
        directions,
        np.full(len(directions), np.inf, np.float32),
    )
    for _ in range(bounces):
        hits = world.nearest(rays)
        met = np.flatnonzero(hits.triangle >= 0)
        away = np.flatnonzero(hits.triangle < 0)
        radiance[path[away]] = throughput[away]
        path, throughput = path[met], throughput[met]
        surface = tables.surface(
            hits.triangle[met],
            hits.barycentric[met],
            rays.directions[met],
        )
        inside = surface.glass.solid & ~surface.glass.entering
        throughput[inside] *= np.exp(-surface.glass.absorption * hits.t[met][:, None])[inside]
        onward, goes_on = np.empty((len(met), 3), np.float32), np.empty(len(met), np.bool_)
        scatter(surface, rng.random((len(met), 3)), throughput, onward, goes_on)
        left = np.flatnonzero(goes_on)
        path, throughput = path[left], throughput[left]
        rays = rays_from(surface.chosen(left), onward[left], np.full(len(left), np.inf, np.float32))
        if not len(left):
            break
    return radiance


def aimed(rng, count, spread):
    """Rays from the unit sphere of radius 4 to within `spread` of the middle."""
    origins = 4.0 * random_directions(rng, count)
    towards = spread * random_directions(rng, count) * rng.random((count, 1)) - origins
    return origins, towards / np.linalg.norm(towards, axis=1, keepdims=True)


@pytest.mark.parametrize("ior", [1.0, 1.33, 1.5, 2.4])
def test_a_smooth_ball_in_a_furnace_is_invisible(rng, ior):
    ball = scene_of("ball", [Part(sphere(1.0, 40), 0)], [replace(GLASS, ior=ior)])
    radiance = seen(ball, *aimed(rng, 4000, 0.9), rng)
    assert radiance.mean() == pytest.approx(1, abs=0.01)
    # Facets of the mesh turn shading normals away from triangles: few paths get lost
    assert (radiance[:, 0] < 0.9).mean() < 0.02
    assert radiance.max() < 1.001


def test_rough_glass_loses_what_its_lobes_lose_and_gains_nothing(rng):
    ball = scene_of("ball", [Part(sphere(1.0, 40), 0)], [replace(GLASS, roughness=0.6)])
    radiance = seen(ball, *aimed(rng, 4000, 0.9), rng)
    assert 0.6 < radiance.mean() < 0.95
    assert radiance.max() <= 1.001


def test_a_slab_absorbs_along_the_way_that_rays_go_inside(rng):
    """R + (1 - R)^2 a / (1 - R a), at right angles, for light from both sides."""
    absorption = np.array([0.0, 0.5, 3.0])
    material = replace(GLASS, absorption=tuple(absorption))
    slab = scene_of("slab", [Part(box(40.0, 0.7, 40.0), 0)], [material])
    count = 20_000
    origins = np.column_stack([rng.uniform(-1, 1, (count, 2)), np.full(count, 5.0)])[:, [0, 2, 1]]
    radiance = seen(slab, origins, np.tile([0, -1.0, 0], (count, 1)), rng).mean(axis=0)
    left = np.exp(-absorption * 0.7)
    expected = 0.04 + 0.96**2 * left / (1 - 0.04 * left)
    np.testing.assert_allclose(radiance, expected, rtol=0.01)


def test_a_slab_seen_aslant_is_longer(rng):
    """At 60 degrees the way inside is 1 / cos of the refracted angle."""
    material = replace(GLASS, absorption=(3.0, 3.0, 3.0))
    slab = scene_of("slab", [Part(box(400.0, 0.7, 400.0), 0)], [material])
    count = 20_000
    towards = np.array([math.sin(math.pi / 3), -math.cos(math.pi / 3), 0])
    radiance = seen(
        slab, np.tile([0, 5.0, 0], (count, 1)), np.tile(towards, (count, 1)), rng
    ).mean()
    reflected = 0.04 + 0.96 * 0.5**5
    left = math.exp(-3.0 * 0.7 / math.sqrt(1 - 0.75 / 2.25))
    expected = reflected + (1 - reflected) ** 2 * left / (1 - reflected * left)
    assert radiance == pytest.approx(expected, rel=0.02)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_sheet_tints_what_goes_straight_through(rng, side):
    colour = np.array([0.9, 0.5, 0.1])
    material = Material(
        base_colour=(*colour, 1.0), metallic=0.0, roughness=0.0, transmission=1.0, double_sided=True
    )
    pane = scene_of("pane", [Part(sheet(40.0, 40.0, 1, 1), 0)], [material])
    count = 20_000
    down = np.tile([0.6, -0.8 * side, 0], (count, 1))
    radiance = seen(pane, np.tile([0, 3.0 * side, 0], (count, 1)), down, rng).mean(axis=0)
    reflected = 0.04 + 0.96 * 0.2**5
    np.testing.assert_allclose(radiance, reflected + (1 - reflected) * colour, rtol=0.01)
