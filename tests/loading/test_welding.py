"""Normals for meshes that have none, against one corner at a time."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from raysvc.builtin.shapes import sphere, torus
from raysvc.loading.welding import crease_normals


def corner_normal(positions, triangles, face, corner, crease_deg):
    """Angle-weighted mean over triangles reached from this one across smooth edges at this
    place."""
    corners = positions[triangles]
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    faces /= np.linalg.norm(faces, axis=1, keepdims=True)
    here = tuple(corners[face, corner])
    around = [f for f in range(len(triangles)) if here in map(tuple, corners[f])]
    reached, fresh = {face}, [face]
    while fresh:
        f = fresh.pop()
        for g in around:
            shared = {tuple(p) for p in corners[f]} & {tuple(p) for p in corners[g]}
            turn = np.degrees(np.arccos(np.clip(faces[f] @ faces[g], -1, 1)))
            if g not in reached and len(shared) == 2 and turn < crease_deg:
                reached.add(g)
                fresh.append(g)
    total = np.zeros(3)
    for f in reached:
        k = [tuple(p) for p in corners[f]].index(here)
        a, b = corners[f, (k + 1) % 3] - corners[f, k], corners[f, (k + 2) % 3] - corners[f, k]
        cosine = a @ b / np.linalg.norm(a) / np.linalg.norm(b)
        total += faces[f] * np.arccos(np.clip(cosine, -1, 1))
    return total / np.linalg.norm(total)


def hills(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """A rough height field whose creases are of every angle."""
    rng = np.random.default_rng(seed)
    x, z = np.meshgrid(np.arange(5.0), np.arange(4.0))
    positions = np.stack([x, rng.random(x.shape) * 2.5, z], axis=-1).reshape(-1, 3)
    here = (np.arange(3)[:, None] * 5 + np.arange(4)).reshape(-1)
    cells = np.stack([here, here + 5, here + 6, here, here + 6, here + 1], axis=1)
    return positions, cells.reshape(-1, 3)


@pytest.mark.parametrize("is_soup", [False, True])
@given(seed=st.integers(min_value=0, max_value=10_000))
def test_normals_are_those_of_the_slow_way(is_soup, seed):
    positions, triangles = hills(seed)
    expected = [
        [corner_normal(positions, triangles, f, k, 60.0) for k in range(3)]
        for f in range(len(triangles))
    ]
    if is_soup:
        positions, triangles = positions[triangles].reshape(-1, 3), np.arange(72).reshape(-1, 3)
    source, new_triangles, normals = crease_normals(positions, triangles)
    assert np.array_equal(source[new_triangles], triangles)
    assert np.allclose(normals[new_triangles], expected, atol=1e-6)


@pytest.mark.parametrize("mesh", [sphere(1.0, 40), torus(1.0, 0.4, 40, 8_000)])
def test_smooth_shapes_get_nearly_their_own_normals_and_no_creases(mesh):
    source, _, normals = crease_normals(mesh.positions, mesh.triangles)
    assert len(source) == len(mesh.positions)
    assert np.einsum("vk,vk->v", normals, mesh.normals[source]).min() > 0.995


def test_triangles_without_area_neither_harm_their_neighbours_nor_have_nan():
    positions = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0.5, 0, 0]])
    triangles = np.array([[0, 1, 2], [0, 3, 1], [3, 3, 3]])
    _, new_triangles, normals = crease_normals(positions, triangles)
    assert np.allclose(normals[new_triangles[0]], [0, 0, 1])
    assert np.allclose(np.linalg.norm(normals, axis=1), 1)


def test_no_triangles_give_no_vertices():
    source, triangles, normals = crease_normals(np.zeros((3, 3)), np.zeros((0, 3), np.int64))
    assert source.shape == (0,)
    assert triangles.shape == (0, 3)
    assert normals.shape == (0, 3)


def test_a_vertex_with_very_many_triangles_takes_little_time():
    count = 100_000
    turn = 2 * np.pi * np.arange(count) / count
    rim = np.column_stack([np.cos(turn), np.zeros(count), -np.sin(turn)])
    ring = np.arange(count)
    triangles = np.column_stack([np.zeros(count, int), 1 + ring, 1 + (ring + 1) % count])
    source, _, normals = crease_normals(np.vstack([np.zeros(3), rim]), triangles)
    assert len(source) == count + 1
    assert np.allclose(normals, [0, 1, 0])
