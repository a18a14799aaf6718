"""Shapes made in code: exact counts, closed surfaces, normals that point out."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from raysvc.builtin.mesh import Mesh
from raysvc.builtin.shapes import apportioned, box, disc, fine_disc, frustum, sheet, sphere, torus


def volume(mesh: Mesh) -> float:
    a, b, c = (mesh.positions[mesh.triangles[:, corner]] for corner in range(3))
    return float(np.einsum("fk,fk->", a, np.cross(b, c)) / 6)


def open_edges(mesh: Mesh) -> int:
    """Number of directed edges without an opposite one, places counted as one to 1e-9."""
    _, place = np.unique(np.round(mesh.positions, 9), axis=0, return_inverse=True)
    corners = place.reshape(-1)[mesh.triangles]
    edges = {
        (int(t[i]), int(t[(i + 1) % 3])) for t in corners for i in range(3) if t[i] != t[i - 2]
    }
    return sum((b, a) not in edges for a, b in edges)


def agreement(mesh: Mesh) -> float:
    """Least cosine between a triangle's own normal and its vertices' normals."""
    corners = mesh.positions[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return float(np.einsum("fk,fvk->fv", normals, mesh.normals[mesh.triangles]).min())


CLOSED = {
    "torus": (torus(1.0, 0.4, 24, 3_336), 2 * np.pi**2 * 0.4**2),
    "sphere": (sphere(0.7, 24), 4 / 3 * np.pi * 0.7**3),
    "box": (box(1.0, 2.0, 3.0), 6.0),
}


@pytest.mark.parametrize("name", CLOSED)
def test_closed_shapes_have_no_open_edges_and_their_volume(name: str) -> None:
    mesh, expected = CLOSED[name]
    assert open_edges(mesh) == 0
    assert volume(mesh) == pytest.approx(expected, rel=0.02)
    assert agreement(mesh) > 0.9


@given(st.integers(min_value=400, max_value=4_000))
def test_a_torus_has_exactly_the_triangles_asked_for(half: int) -> None:
    assert len(torus(1.0, 0.3, 16, 2 * half).triangles) == 2 * half


@given(st.integers(min_value=600, max_value=3_000))
def test_a_fine_disc_has_exactly_the_triangles_asked_for(triangles: int) -> None:
    mesh = fine_disc(np.linspace(2.0, 0.2, 8), triangles)
    assert len(mesh.triangles) == triangles
    assert agreement(mesh) == pytest.approx(1.0)


@given(
    st.integers(min_value=0, max_value=10_000),
    st.lists(st.floats(min_value=0.01, max_value=100.0), min_size=1, max_size=20),
)
def test_shares_add_up_and_differ_from_the_exact_ones_by_less_than_one(
    total: int, weights: list[float]
) -> None:
    exact = total * np.array(weights) / np.sum(weights)
    shares = apportioned(total, np.array(weights))
    assert shares.sum() == total
    assert np.abs(shares - exact).max() < 1.0 + 1e-9


def test_discs_face_up_or_down() -> None:
    assert np.allclose(disc(1.0, 12).normals, [0, 1, 0])
    assert np.allclose(disc(1.0, 12, facing_up=False).normals, [0, -1, 0])
    assert agreement(disc(1.0, 12, facing_up=False)) == pytest.approx(1.0)


def test_a_cone_has_its_tip_at_the_top() -> None:
    cone = frustum(1.0, 0.0, 2.0, 32)
    assert len(cone.triangles) == 32
    assert cone.positions[cone.positions[:, 1] > 1.9][:, [0, 2]] == pytest.approx(0.0)


@pytest.mark.parametrize("mesh", [sheet(2.0, 3.0, 3, 4), torus(1.0, 0.4, 24, 3_336), box(1, 1, 1)])
def test_tangents_follow_u_and_their_handedness_points_against_v(mesh: Mesh) -> None:
    corners, uv = mesh.positions[mesh.triangles], mesh.uv[mesh.triangles]
    e1, e2 = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    d1, d2 = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    det = (d1[:, 0] * d2[:, 1] - d2[:, 0] * d1[:, 1])[:, None]
    assert np.all(np.abs(det) > 1e-12)
    along_u = (e1 * d2[:, 1:] - e2 * d1[:, 1:]) / det
    along_v = (e2 * d1[:, :1] - e1 * d2[:, :1]) / det
    tangents, normals = mesh.tangents[mesh.triangles[:, 0]], mesh.normals[mesh.triangles[:, 0]]
    bitangents = np.cross(normals, tangents[:, :3]) * tangents[:, 3:]
    assert np.einsum("fk,fk->f", along_u, tangents[:, :3]).min() > 0
    assert np.einsum("fk,fk->f", along_v, bitangents).max() < 0


def test_turning_is_counter_clockwise_seen_from_the_tip_of_the_axis() -> None:
    arrow = sheet(1.0, 1.0, 1, 1).moved([1.0, 0.0, 0.0])
    assert arrow.turned(90, 1).positions.mean(axis=0) == pytest.approx([0.0, 0.0, -1.0])
    assert arrow.turned(90, 2).positions.mean(axis=0) == pytest.approx([0.0, 1.0, 0.0])


def test_scaling_keeps_normals_perpendicular_to_the_surface() -> None:
    ellipsoid = sphere(1.0, 24).scaled((1.0, 3.0, 0.5))
    assert agreement(ellipsoid) > 0.8


def test_a_mesh_can_be_set_along_a_direction(rng: np.random.Generator) -> None:
    direction = rng.normal(size=3)
    direction /= np.linalg.norm(direction)
    post = frustum(0.1, 0.1, 2.0, 8).upright_along(direction)
    top = post.positions[post.positions @ direction > 1.0]
    assert top.mean(axis=0) == pytest.approx(2.0 * direction, abs=0.03)
    assert volume(box(1, 1, 1).upright_along(direction)) == pytest.approx(1.0)
