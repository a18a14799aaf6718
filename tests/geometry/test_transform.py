"""Poses: what a camera's axes are, and that what is framed is in the picture."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from raysvc.geometry.transform import framed_distance, look_at, unit

COORDINATE = st.floats(-1e3, 1e3)
POINT = st.tuples(COORDINATE, COORDINATE, COORDINATE).map(np.array)


def test_unit_vectors_have_length_one_and_zero_stays_zero():
    vectors = np.array([[3.0, 0, 4], [0, 0, 0], [1e-200, 0, 0]])
    assert unit(vectors).tolist() == [[0.6, 0, 0.8], [0, 0, 0], [1, 0, 0]]


def test_a_camera_on_the_z_axis_has_the_axes_of_the_world():
    pose = look_at(np.array([0, 0, 5.0]), np.zeros(3), np.array([0, 1.0, 0]))
    expected = np.eye(4)
    expected[2, 3] = 5
    assert np.allclose(pose, expected)


@given(POINT, POINT, POINT)
def test_axes_are_right_handed_and_look_at_the_target(eye, target, up):
    assume(np.linalg.norm(eye - target) > 1e-3)
    pose = look_at(eye, target, up)
    axes = pose[:3, :3]
    assert np.allclose(axes.T @ axes, np.eye(3), atol=1e-9)
    assert np.linalg.det(axes) > 0
    assert (pose[:3, 3] == eye).all()
    assert (pose[3] == [0, 0, 0, 1]).all()
    assert np.allclose(-axes[:, 2], unit(target - eye))
    # Up in the picture leans towards the up that was asked for.
    assert axes[:, 1] @ unit(up) >= -1e-9


@pytest.mark.parametrize("along", [1.0, -1.0])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_view_along_up_still_has_axes(axis, along):
    up = np.eye(3)[axis]
    pose = look_at(np.zeros(3), up * along, up)
    assert np.allclose(pose[:3, :3].T @ pose[:3, :3], np.eye(3))
    assert np.allclose(-pose[:3, 2], up * along)


@pytest.mark.parametrize("length", [1e-11, 1.0, 1e11])
def test_only_the_direction_of_up_matters(length):
    pose = look_at(np.array([0, 0, 5.0]), np.zeros(3), np.array([length, 0, 0]))
    assert np.allclose(pose[:3, 1], [1, 0, 0])


@given(POINT, POINT, POINT, st.floats(0.05, 3.0), st.floats(0.05, 3.0))
def test_what_is_framed_is_in_the_picture(low, size, away, tan_x, tan_y):
    size = np.abs(size) + 1e-3
    assume(np.linalg.norm(away) > 1e-2)
    corners = low + size * np.stack(np.meshgrid([0, 1], [0, 1], [0, 1]), axis=-1).reshape(8, 3)
    middle = corners.mean(axis=0)
    pose = look_at(middle + unit(away), middle, np.array([0, 1.0, 0]))
    pose[:3, 3] = middle
    margin = 1.1
    distance = framed_distance(corners, pose, (tan_x, tan_y), margin)
    eye = middle + pose[:3, 2] * distance
    local = (corners - eye) @ pose[:3, :3]
    depth = -local[:, 2]
    slack = 1e-9 * np.abs(corners).max()
    assert (depth >= -slack).all()
    used = np.abs(local[:, :2]) * margin - np.array([tan_x, tan_y]) * depth[:, None]
    assert used.max() == pytest.approx(0, abs=1e-6 * np.abs(corners).max() + slack)
