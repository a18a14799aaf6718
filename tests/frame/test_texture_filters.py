"""How near texture filters come to many samples: a chequerboard mirrored in a torus."""

import numpy as np
import pytest

import raysvc
from bench.texture_filters import (
    board_pixels,
    errors,
    rendered,
    torus_over_board,
    true_radiance,
)
from tests.frame.subjects import VIEW, still_life

SIZE = (48, 36)


@pytest.fixture(scope="module")
def error() -> dict[str, float]:
    """Mean absolute error of each filter against 64 samples per pixel."""
    scene = torus_over_board()
    truth, compared = true_radiance(scene, *SIZE, samples=16), board_pixels(*SIZE)
    assert compared.sum() > 300
    return {
        name: errors(rendered(scene, *SIZE, name)[1], truth, compared)[0]
        for name in ("bilinear", "mip", "sat", "ewa")
    }


def test_ellipses_are_nearest_to_the_truth(error: dict[str, float]) -> None:
    assert error["ewa"] <= 0.15 * error["bilinear"]
    assert error["ewa"] <= 0.4 * error["mip"]


def test_rectangles_come_next(error: dict[str, float]) -> None:
    assert error["ewa"] <= error["sat"] <= 0.5 * error["mip"]


def test_what_a_pixel_shows_of_squares_is_what_it_covers_of_them() -> None:
    """The chequer of the still life has a nearest sampler: its edges are only as wide as pixels."""
    plain = {"aa": "none", "occlusion_samples": 0, "shadows": False, "bounces": 0}
    one = raysvc.render(still_life(), camera=VIEW, settings=plain)
    sharp = raysvc.render(still_life(), camera=VIEW, settings=plain | {"texture_filter": "nearest"})
    truth = raysvc.render(
        still_life(),
        camera=VIEW | {"width": 8 * VIEW["width"], "height": 8 * VIEW["height"]},
        settings=plain | {"texture_filter": "nearest"},
    )
    parts = truth.layers["albedo"].reshape(VIEW["height"], 8, VIEW["width"], 8, 3)
    floor = (
        (truth.layers["object"] == 0).reshape(VIEW["height"], 8, VIEW["width"], 8).all(axis=(1, 3))
    )
    mean = parts.mean(axis=(1, 3))
    away = [float(np.abs(frame.layers["albedo"] - mean)[floor].mean()) for frame in (one, sharp)]
    assert away[0] < 0.3 * away[1]
