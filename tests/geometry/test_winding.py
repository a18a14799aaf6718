"""How often surfaces go around a point."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from raysvc.builtin.shapes import box, sheet, sphere
from raysvc.geometry.winding import signed_solid_angles, windings
from tests.oracles.solid_angle import solid_angle

places = st.tuples(*[st.floats(-3, 3)] * 3)


def corners_of(mesh):
    return mesh.positions[mesh.triangles]


@given(st.integers(0, 2**32 - 1), places)
def test_solid_angles_are_those_of_the_slow_twin(seed, point) -> None:
    corners = np.random.default_rng(seed).normal(size=(5, 3, 3))
    found = signed_solid_angles(corners, np.array(point))
    wanted = [solid_angle(triangle - point) for triangle in corners]
    np.testing.assert_allclose(np.abs(found), wanted, atol=1e-6)


@given(places)
def test_a_closed_surface_goes_once_around_what_is_inside(point) -> None:
    cube = corners_of(box(2.0, 2.0, 2.0).moved([0, -1, 0]))
    from_walls = np.abs(point).max() - 1.0
    if abs(from_walls) < 1e-3:
        return
    winding = windings(cube, np.zeros(len(cube), np.int32), 1, np.array(point))
    np.testing.assert_allclose(winding, 1.0 if from_walls < 0 else 0.0, atol=1e-6)


def test_groups_are_told_apart_and_rooms_go_the_other_way() -> None:
    ball, room = corners_of(sphere(1.0, 12)), corners_of(box(8.0, 8.0, 8.0).moved([0, -4, 0]))
    corners = np.concatenate([ball, room[:, ::-1]])
    group = np.repeat(np.array([0, 1], np.int32), [len(ball), len(room)])
    np.testing.assert_allclose(windings(corners, group, 3, np.zeros(3)), [1, -1, 0], atol=1e-9)


def test_a_sheet_never_goes_more_than_half_around() -> None:
    floor = corners_of(sheet(1e4, 1e4, 1, 1))
    group = np.zeros(len(floor), np.int32)
    below, above, on = (windings(floor, group, 1, np.array([0, y, 0.3])) for y in (-1, 1, 0.0))
    assert 0.49 < below[0] < 0.5
    assert above[0] == pytest.approx(-below[0])
    assert on[0] == 0.0
