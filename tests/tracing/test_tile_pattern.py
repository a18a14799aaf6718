"""Points shared out over tiles of pixels: every aligned block holds a net."""

import numpy as np
import pytest

from raysvc.tracing.tile_pattern import RAYS, TILE, dealt_points, place_in_tile, tile_points

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


def is_a_net(points):
    count = len(points)
    return all(
        len(np.unique((points * [across, count // across]).astype(int), axis=0)) == count
        for across in [2**k for k in range(count.bit_length())]
    )


@pytest.mark.parametrize("seed", [0, 3, 2009])
def test_dealt_points_are_nets_by_place_by_ray_by_block_and_all_together(seed):
    dealt = dealt_points(seed)
    assert dealt.shape == (16, RAYS, 2)
    assert is_a_net(dealt.reshape(-1, 2))
    assert all(is_a_net(own) for own in dealt)
    for ray in range(RAYS):
        assert is_a_net(dealt[:, ray])
        for block in range(0, 16, 4):
            assert is_a_net(dealt[block : block + 4, ray])
