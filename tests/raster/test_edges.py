"""Where more samples are taken, on drawn examples."""

import numpy as np
import pytest

from raysvc.raster.edge_kernels import UNKNOWN
from raysvc.raster.edges import shadow_edges, surface_edges, visible_contrast


def shown(mask):
    return ["".join("#" if flag else "." for flag in row) for row in mask]


def mask(part=None, depth=None, normal=None, shape=(3, 6)):
    part = np.zeros(shape, np.int32) if part is None else np.array(part, np.int32)
    depth = np.ones(part.shape, np.float32) if depth is None else np.array(depth, np.float32)
    if normal is None:
        normal = np.zeros((*part.shape, 3), np.float32)
        normal[..., 2] = part >= 0
    return shown(surface_edges(part, depth, np.array(normal, np.float32)))


def test_a_flat_face_has_no_edges():
    assert mask() == ["......"] * 3


def test_both_sides_of_a_border_between_parts_are_edges():
    part = [[0, 0, 0, 1, 1, 1]] * 3
    assert mask(part) == ["..##.."] * 3


def test_the_outline_against_nothing_is_an_edge_on_both_sides():
    part = [[-1, -1, -1, 4, 4, 4]] * 3
    depth = np.where(np.array(part) < 0, np.inf, 2.0)
    assert mask(part, depth) == ["..##.."] * 3


def test_a_lone_pixel_and_its_four_neighbours_are_edges():
    part = [[0, 0, 0, 0, 0], [0, 0, 0, 0, 0], [0, 0, 7, 0, 0], [0, 0, 0, 0, 0]]
    assert mask(part) == [".....", "..#..", ".###.", "..#.."]


def test_a_crease_is_an_edge():
    normal = np.zeros((3, 6, 3))
    normal[:, :3, 2] = 1
    normal[:, 3:, 0] = 1
    assert mask(normal=normal) == ["..##.."] * 3


def test_a_step_of_depth_within_a_part_is_an_edge():
    assert mask(depth=[[1, 1, 1, 1.5, 1.5, 1.5]] * 3) == ["..##.."] * 3


def test_a_slanted_plane_has_no_edges_even_where_it_recedes_fast():
    # Rows of a ground plane below the horizon: depth is one over the row.
    rows = np.arange(40, 1, -1)[:, None] * np.ones((1, 5))
    assert mask(np.zeros(rows.shape), 30.0 / rows) == ["....."] * len(rows)


def test_a_slanted_plane_has_no_edges_for_an_orthographic_camera_either():
    rows = 0.5 + np.arange(12)[:, None] * np.ones((1, 5))
    assert mask(np.zeros(rows.shape), rows) == ["....."] * 12


def test_nothing_has_no_edges():
    part = np.full((3, 6), -1)
    assert mask(part, np.full((3, 6), np.inf)) == ["......"] * 3


def test_pictures_of_one_pixel_or_row_are_possible():
    assert mask(shape=(1, 1)) == ["."]
    assert mask([[0, 0, 1, 1]]) == [".##."]
    assert mask([[0], [1], [1]]) == ["#", "#", "."]


def test_pixels_of_which_nothing_is_known_make_no_edges():
    part = [[0, 0, UNKNOWN, 1, 1, 1]] * 3
    assert mask(part) == ["......"] * 3


def test_a_shadow_has_edges_where_half_the_light_is_lost_within_a_part():
    part = np.array([[3, 3, 3, 3, 3, 5]], np.int32)
    light = np.array([[1.0, 0.9, 0.44, 0.3, 0.25, 0.0]], np.float32)
    assert shown(shadow_edges(part, light)) == [".##..."]
    assert shown(shadow_edges(np.full((1, 6), -1, np.int32), light)) == ["......"]


def test_contrast_is_the_greatest_difference_to_a_neighbour_as_a_screen_shows_it():
    picture = np.full((3, 4, 4), 0.2, np.float32)
    picture[..., 3] = 1.0
    picture[1, 0, 1] = 0.8
    contrast = visible_contrast(picture)
    step = np.sqrt(0.8 / 1.8) - np.sqrt(0.2 / 1.2)
    assert contrast[[0, 1, 1, 2], [0, 0, 1, 0]] == pytest.approx(step)
    assert (contrast[:, 2:] == 0).all() and contrast[0, 1] == 0


def test_contrast_does_not_depend_on_how_bright_the_light_is(rng):
    picture = rng.random((8, 8, 4), dtype=np.float32)
    brighter = picture.copy()
    brighter[..., :3] *= 1024.0
    assert visible_contrast(brighter) == pytest.approx(visible_contrast(picture), abs=1e-6)


def test_contrast_counts_outlines_of_what_is_black_and_darkness_is_even():
    picture = np.zeros((2, 3, 4), np.float32)
    picture[:, 0, 3] = 1.0
    assert visible_contrast(picture) == pytest.approx(np.array([[1.0, 1.0, 0.0]] * 2))
    assert (visible_contrast(np.zeros((2, 3, 4), np.float32)) == 0).all()
