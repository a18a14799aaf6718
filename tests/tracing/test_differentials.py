"""Differentials of rays that are traced through a scene, against differences of their paths."""

from typing import NamedTuple

import numpy as np
import pytest

from raysvc import records
from raysvc.accel.base import Rays
from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import sheet, sphere
from raysvc.scene import Material
from raysvc.shading.footprint import Footprint
from raysvc.shading.scene_tables import SceneTables
from raysvc.tracing import differentials
from raysvc.tracing.differentials import (
    footprint_at,
    pixel_angle,
    primary_differentials,
    reflected,
    refracted,
)
from raysvc.tracing.ray_differentials import RayDifferentials
from raysvc.tracing.reflection import mirror_rays, rays_from
from raysvc.tracing.world import World
from tests.oracles.ray_path import Triangle, central_difference, follow, unit
from tests.scenes import camera, quad

GLASS = 1.5


def balls():
    """Three smooth balls and a floor, all of one material: what happens there is the path's."""
    parts = [
        Part(sphere(1.0, 30).moved([0, 1, 0]), 0),
        Part(sphere(0.8, 30).moved([2.0, 1.2, -0.4]), 0),
        Part(sphere(0.9, 30).moved([-1.9, 1.3, 0.5]), 0),
        Part(sheet(40.0, 40.0, 1, 1), 0),
    ]
    return scene_of("balls", parts, [Material(double_sided=True)])


class Followed(NamedTuple):
    """Rays that met something at every step of a path."""

    pixel: np.ndarray
    triangle: np.ndarray
    """(N, steps)."""
    grazing: np.ndarray
    """(N,) least cosine between ray and triangle."""
    off: np.ndarray
    """(N, steps, 3) from where each surface was met to where the next ray starts."""
    footprint: Footprint
    """At the end."""


def followed(scene, eye, events, width=40, height=30):
    """Send a camera's rays along a path: "reflect", ("refract", eta), and "end"."""
    tables = SceneTables.of(scene)
    world = World(scene, tables, "auto")
    pixel = np.arange(width * height)
    origins, directions = eye.rays(pixel)
    rays = Rays(origins, directions, np.full(len(pixel), np.inf, np.float32))
    differentials = primary_differentials(eye, directions)
    path, off = np.zeros((len(pixel), 0), int), np.zeros((len(pixel), 0, 3))
    grazing = np.ones(len(pixel))
    for event in events:
        hits = world.nearest(rays)
        met = np.flatnonzero(hits.triangle >= 0)
        pixel, path, off, grazing = pixel[met], path[met], off[met], grazing[met]
        hits = records.chosen(hits, met)
        directions = rays.directions[met]
        differentials = records.chosen(differentials, met)
        path = np.column_stack([path, hits.triangle])
        footprint = footprint_at(tables.geometry, hits.triangle, hits.t, directions, differentials)
        surface = tables.surface(hits.triangle, hits.barycentric, directions)
        for normal in (surface.geometric_normal, surface.normal):
            grazing = np.minimum(grazing, np.einsum("nk,nk->n", normal, surface.to_viewer))
        if event == "end":
            return Followed(pixel, path, grazing, off, footprint)
        nothing = np.zeros(len(met), np.float32)
        if event == "reflect":
            rays = mirror_rays(surface)
            differentials = reflected(
                tables.geometry,
                hits.triangle,
                surface,
                rays.directions,
                differentials,
                footprint,
                nothing,
            )
        else:
            rays, kept = _refracted_rays(surface, event[1])
            grazing[~kept] = 0
            differentials = refracted(
                tables.geometry,
                hits.triangle,
                surface,
                rays.directions,
                differentials,
                footprint,
                nothing,
                np.full(len(met), event[1], np.float32),
            )
        start = rays.origins.astype(float) - surface.position
        off = np.concatenate([off, start[:, None]], axis=1)
    raise AssertionError("a path has an end")


def _refracted_rays(surface, eta):
    normal, direction = surface.normal.astype(float), -surface.to_viewer.astype(float)
    cosine = (normal * direction).sum(axis=1)
    square = 1 - eta**2 * (1 - cosine**2)
    bend = eta * cosine + np.sqrt(np.maximum(square, 0))
    directions = eta * direction - bend[:, None] * normal
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return rays_from(surface, directions, np.full(len(normal), np.inf)), square > 0.05


def direction_of(eye, x, y):
    """The camera's unit direction in double precision, at pixels to the right and down."""
    scale = eye.metres_per_pixel_at_unit_depth
    across = (x + 0.5 - eye.width / 2) * scale, (eye.height / 2 - y - 0.5) * scale
    right, up, back = eye.world_from_camera[:3, :3].T
    return unit(across[0] * right + across[1] * up - back)


CHAINS = {
    "a mirror": ["reflect", "end"],
    "two mirrors": ["reflect", "reflect", "end"],
    "three mirrors": ["reflect", "reflect", "reflect", "end"],
    "glass": [("refract", 1 / GLASS), ("refract", GLASS), "end"],
    "a mirror, then glass": ["reflect", ("refract", 1 / GLASS), ("refract", GLASS), "end"],
    "two mirrors, then glass": [
        "reflect", "reflect", ("refract", 1 / GLASS), ("refract", GLASS), "end"
    ],
}  # fmt: skip


@pytest.mark.parametrize("events", CHAINS.values(), ids=CHAINS.keys())
def test_footprints_after_bounces_are_differences_of_paths(events):
    scene = balls()
    eye = camera(eye=(0.3, 2.4, 6.0), target=(0.1, 1.0, 0), width=40, height=30)
    seen = followed(scene, eye, events)
    usable = np.flatnonzero(seen.grazing > 0.2)
    assert len(usable) >= 10
    corners = scene.positions.astype(float)[scene.triangles]
    normals = scene.normals.astype(float)[scene.triangles]
    wrong = []
    for n in usable[:: max(len(usable) // 40, 1)]:
        path = [
            (Triangle(corners[f], normals[f]), event, off)
            for f, event, off in zip(seen.triangle[n], events[:-1], seen.off[n], strict=False)
        ]
        path.append((Triangle(corners[seen.triangle[n, -1]], normals[0]), None))
        y, x = divmod(int(seen.pixel[n]), eye.width)

        def end(x, y, path=path):
            return follow(eye.eye, direction_of(eye, x, y), path)[-1][0]

        expected = [
            central_difference(lambda at, y=y, end=end: end(at, y), x, 1e-3),
            central_difference(lambda at, x=x, end=end: end(x, at), y, 1e-3),
        ]
        for found, truth in zip(
            (seen.footprint.dpdx[n], seen.footprint.dpdy[n]), expected, strict=True
        ):
            wrong.append(np.linalg.norm(found - truth) / np.linalg.norm(truth))
    # Rays are of single precision, and curved mirrors multiply its rounding.
    assert np.median(wrong) < 5e-6
    assert np.max(wrong) < 1e-4


def orthographic(**more):
    return camera(projection="orthographic", half_height=2.0, **more)


def test_an_orthographic_cameras_rays_keep_their_direction():
    eye = orthographic(eye=(0, 0, 5), width=20, height=10)
    _, directions = eye.rays(np.arange(200))
    differentials = primary_differentials(eye, directions)
    assert (differentials.direction_dx == 0).all() and (differentials.direction_dy == 0).all()
    assert differentials.origin_dx[7] == pytest.approx([0.4, 0, 0])
    assert differentials.origin_dy[7] == pytest.approx([0, -0.4, 0])
    assert pixel_angle(differentials, np.full(200, 8.0, np.float32)) == pytest.approx(
        np.full(200, 0.05)
    )
    assert (pixel_angle(differentials, np.full(200, np.inf, np.float32)) == 0).all()


def test_a_perspective_cameras_rays_turn_by_a_pixel():
    eye = camera(width=20, height=10)
    pixel = np.arange(200)
    _, directions = eye.rays(pixel)
    differentials = primary_differentials(eye, directions)
    for name, step in (("direction_dx", (0.1, 0)), ("direction_dy", (0, 0.1))):
        here = directions.astype(float)
        there = eye.rays(pixel, np.tile(step, (200, 1)))[1].astype(float)
        back = eye.rays(pixel, np.tile(np.negative(step), (200, 1)))[1].astype(float)
        turn = getattr(differentials, name)
        assert turn == pytest.approx((there - back) / 0.2, abs=1e-5)
        assert np.einsum("nk,nk->n", turn, here) == pytest.approx(np.zeros(200), abs=1e-7)
    half = primary_differentials(eye, directions, 0.5)
    assert half.direction_dx == pytest.approx(differentials.direction_dx / 2)
    middle = pixel_angle(differentials, np.full(200, np.inf, np.float32)).max()
    assert middle == pytest.approx(eye.metres_per_pixel_at_unit_depth, rel=0.01)


def one_ray(scene, origin, direction, blur=0.0, widening=0.0):
    """A ray, its hit, what is seen there, and the surface."""
    tables = SceneTables.of(scene)
    rays = Rays(
        np.array([origin], np.float32),
        np.array([unit(direction)], np.float32),
        np.full(1, np.inf, np.float32),
    )
    hits = World(scene, tables, "brute").nearest(rays)
    differentials = RayDifferentials(
        *(np.zeros((1, 3), np.float32) for _ in range(4)),
        np.array([blur], np.float32),
        np.array([widening], np.float32),
    )
    footprint = footprint_at(tables.geometry, hits.triangle, hits.t, rays.directions, differentials)
    surface = tables.surface(hits.triangle, hits.barycentric, rays.directions, footprint, "nearest")
    return tables.geometry, hits, differentials, footprint, surface


def mirrored(scene, *ray, rough=0.0, **cone):
    geometry, hits, arriving, footprint, surface = one_ray(scene, *ray, **cone)
    return reflected(
        geometry,
        hits.triangle,
        surface,
        mirror_rays(surface).directions,
        arriving,
        footprint,
        np.array([rough], np.float32),
    )


def test_a_cone_goes_on_widening_behind_a_flat_mirror():
    leaving = mirrored(quad(), (0.2, 0.1, 3), (0.1, 0.05, -1), blur=0.1, widening=0.02)
    t = 3 * np.linalg.norm([0.1, 0.05, -1])
    assert leaving.blur[0] == pytest.approx(0.1 + 0.02 * t)
    assert leaving.widening[0] == pytest.approx(0.02, rel=1e-4)


def test_roughness_adds_to_a_cone_by_the_square():
    leaving = mirrored(quad(), (0.2, 0.1, 3), (0, 0, -1), widening=0.03, rough=0.04)
    assert leaving.widening[0] == pytest.approx(0.05, rel=1e-4)
    sharp = mirrored(quad(), (0.2, 0.1, 3), (0, 0, -1))
    assert sharp.widening[0] == 0 and sharp.blur[0] == 0


def test_a_ball_spreads_a_cone_as_its_curvature_says():
    radius, blur = 2.0, 0.01
    ball = scene_of("ball", [Part(sphere(radius, 200), 0)], [Material()])
    leaving = mirrored(ball, (0.05, 0.03, 5), (0, 0, -1), blur=blur)
    # A ray that comes in off the axis by b leaves at twice the angle b / radius.
    assert leaving.widening[0] == pytest.approx(2 * blur / radius, rel=0.02)


def test_a_cone_narrows_inside_glass_and_widens_again_behind_it():
    geometry, hits, arriving, footprint, surface = one_ray(
        quad(), (0.1, 0.2, 2), (0, 0, -1), widening=0.1
    )
    straight = -surface.to_viewer
    nothing = np.zeros(1, np.float32)

    def through(eta):
        return refracted(
            geometry,
            hits.triangle,
            surface,
            straight,
            arriving,
            footprint,
            nothing,
            np.array([eta], np.float32),
        )

    assert through(1 / GLASS).widening[0] == pytest.approx(0.1 / GLASS, rel=1e-4)
    assert through(GLASS).widening[0] == pytest.approx(0.1 * GLASS, rel=1e-4)
    assert through(1.0).widening[0] == pytest.approx(0.1, rel=1e-4)


def test_behind_a_thin_pane_everything_goes_on_as_if_there_were_nothing():
    eye = camera(width=8, height=6)
    _, directions = eye.rays(np.arange(48))
    triangle, depth = np.zeros(48, np.int32), -directions[:, 2]

    def seen(z, distance, differentials):
        tables = SceneTables.of(quad(z=z, half=9))
        t = (distance / depth).astype(np.float32)
        return tables, footprint_at(tables.geometry, triangle, t, directions, differentials)

    differentials = primary_differentials(eye, directions)
    tables, pane = seen(0.0, 5.0, differentials)
    assert pane.blur.max() == 0
    surface = tables.surface(triangle, np.full((48, 2), 0.3, np.float32), directions)
    rough, one = np.full(48, 0.1, np.float32), np.ones(48, np.float32)
    behind = refracted(
        tables.geometry, triangle, surface, directions, differentials, pane, rough, one
    )
    through, direct = seen(-2.0, 2.0, behind)[1], seen(-2.0, 7.0, differentials)[1]
    assert through.dpdx == pytest.approx(direct.dpdx, rel=1e-4, abs=1e-6)
    assert through.dpdy == pytest.approx(direct.dpdy, rel=1e-4, abs=1e-6)
    assert through.blur == pytest.approx(0.1 * 2 / depth, rel=1e-5)


def test_whatever_arrives_nothing_infinite_leaves(rng):
    scene = balls()
    tables = SceneTables.of(scene)
    count = 200
    triangle = rng.integers(0, len(scene.triangles), count).astype(np.int32)
    directions = rng.normal(size=(count, 3)).astype(np.float32)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    # Some along their triangles
    edge = np.diff(scene.positions[scene.triangles[triangle[:50], :2]], axis=1)[:, 0]
    directions[:50] = edge / np.linalg.norm(edge, axis=1, keepdims=True)
    large = [rng.normal(size=(count, 3)) * 10.0 ** rng.uniform(-3, 8, (count, 1)) for _ in range(4)]
    arriving = RayDifferentials(
        *(np.clip(array, -1e8, 1e8).astype(np.float32) for array in large),
        *(np.float32(10.0 ** rng.uniform(-3, 8, (2, count)))),
    )
    t = np.float32(10.0 ** rng.uniform(-6, 8, count))
    footprint = footprint_at(tables.geometry, triangle, t, directions, arriving)
    weights = rng.dirichlet([1, 1, 1], count)[:, :2].astype(np.float32)
    for name in ("ewa", "sat", "mip"):
        surface = tables.surface(triangle, weights, directions, footprint, name)
        arrays = [array for array in surface if isinstance(array, np.ndarray)]
        assert all(np.isfinite(array).all() for array in arrays)
    leaving = reflected(
        tables.geometry,
        triangle,
        surface,
        mirror_rays(surface).directions,
        arriving,
        footprint,
        np.ones(count, np.float32),
    )
    for array in (*footprint, *leaving):
        assert np.isfinite(array).all() and np.abs(array).max() <= 1.0001e8


def test_a_ball_mirrors_more_in_a_pixel_the_smaller_and_farther_it_is():
    """Straight ahead a pixel's step of angle a turns the mirrored ray by a (1 + 2 d / r)."""
    scene = scene_of("ball", [Part(sphere(1.0, 60), 0)], [Material(roughness=0.0)])
    tables = SceneTables.of(scene)
    for away in (3.0, 9.0):
        eye = camera(eye=(0.03, 0.02, away), target=(0.03, 0.02, 0.0), width=64, height=64)
        origins, directions = eye.rays(np.array([32 * 64 + 32]))
        rays = Rays(origins, directions, np.full(1, np.inf, np.float32))
        hits = World(scene, tables, "auto").nearest(rays)
        arriving = primary_differentials(eye, directions)
        footprint = footprint_at(tables.geometry, hits.triangle, hits.t, directions, arriving)
        surface = tables.surface(hits.triangle, hits.barycentric, directions, footprint)
        found = differentials.mirrored(tables.geometry, hits.triangle, surface, arriving, footprint)
        angle = eye.metres_per_pixel_at_unit_depth * (1 + 2 * float(hits.t[0]))
        assert found.pixel_sr[0] == pytest.approx(angle**2, rel=0.1)
