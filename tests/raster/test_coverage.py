"""Which pixel's centre shows what a sample beside it shows, on drawn examples."""

import numpy as np

from raysvc.raster.coverage_kernels import find_alike

FACING = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32)
TRIANGLES = np.array([[0, 1, 2], [0, 1, 2], [0, 1, 2], [0, 2, 3]], np.int32)
PART = np.array([7, 7, 8, 7], np.int32)
"""0 and 1 are of one part and face one way; 2 is another part, 3 faces elsewhere."""


def alike(shown, triangle, offset=(0.4, 0.1)):
    """The pixel (row, col) that the middle of 3 x 3 takes a sample's colour from."""
    found = np.empty((1, 1), np.int64)
    find_alike(
        np.array(shown, np.int32),
        FACING,
        TRIANGLES,
        PART,
        np.array([4]),
        np.array([[triangle]], np.int32),
        np.array([offset]),
        found,
    )
    return divmod(int(found[0, 0]), 3)


def test_the_same_triangle_comes_before_all_others():
    assert alike([[0, 0, 0], [1, 0, 0], [1, 1, 1]], 1) == (2, 1)
    assert alike([[0, 0, 1], [0, 0, 0], [0, 0, 0]], 1) == (0, 2)


def test_of_those_that_show_it_the_nearest():
    shown = [[2, 2, 2], [1, 2, 1], [2, 2, 2]]
    assert alike(shown, 1, (0.4, 0.1)) == (1, 2)
    assert alike(shown, 1, (-0.2, 0.1)) == (1, 0)


def test_else_the_same_part_that_faces_the_same_way():
    assert alike([[2, 2, 2], [0, 2, 3], [2, 2, 2]], 1) == (1, 0)


def test_nothing_is_shown_by_pixels_of_nothing():
    assert alike([[2, -1, 2], [2, 2, 2], [2, 2, 2]], -1) == (0, 1)


def test_else_its_own_pixel():
    assert alike([[2, 2, 2], [2, 2, 3], [2, -1, 2]], 1) == (1, 1)


def test_neighbours_outside_the_picture_are_not_asked():
    found = np.empty((1, 2), np.int64)
    find_alike(
        np.array([[2]], np.int32),
        FACING,
        TRIANGLES,
        PART,
        np.array([0]),
        np.array([[1, 2]], np.int32),
        np.array([[0.4, 0.4], [-0.4, -0.4]]),
        found,
    )
    assert found.tolist() == [[0, 0]]
