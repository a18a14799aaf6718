"""Points shared out over tiles of pixels: every aligned block holds a net."""

import numpy as np
import pytest

from raysvc.tracing.tile_pattern import TILE, place_in_tile, tile_points

WIDTH = 24


def points_of_block(seed, row, col, side):
    rows, cols = np.mgrid[row : row + side, col : col + side]
    pixel = (rows * WIDTH + cols).reshape(-1)
    return tile_points(seed)[place_in_tile(pixel, WIDTH)]


@pytest.mark.parametrize("seed", [0, 1, 2009])
@pytest.mark.parametrize("side", [2, 4, 8])
def test_every_aligned_block_has_one_point_in_each_elementary_interval(seed, side):
    count = side * side
    for row in range(0, 16, side):
        for col in range(0, WIDTH, side):
            points = points_of_block(seed, row, col, side)
            for across in [2**k for k in range(count.bit_length())]:
                cells = (points * [across, count // across]).astype(int)
                assert len(np.unique(cells, axis=0)) == count


def test_the_pattern_repeats_and_the_seed_moves_it():
    pixel = np.array([3 * WIDTH + 5])
    assert place_in_tile(pixel, WIDTH) == place_in_tile(pixel + TILE * WIDTH + TILE, WIDTH)
    assert (tile_points(4) == tile_points(4)).all()
    assert (tile_points(4) != tile_points(5)).any()
    assert ((tile_points(4) >= 0) & (tile_points(4) < 1)).all()
