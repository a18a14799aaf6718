"""A structure says only which triangle: the picture is the same with all of them."""

import numpy as np
import pytest

import raysvc
from raysvc.accel.registry import STRUCTURES

CAMERA = {"width": 56, "height": 40}
SETTINGS = {"occlusion_samples": 4, "aa_samples": 2, "bounces": 2}


@pytest.fixture(scope="module")
def expected():
    return raysvc.render(
        raysvc.load("builtin:shiny"), camera=CAMERA, settings={**SETTINGS, "structure": "bvh"}
    )


@pytest.mark.parametrize("name", [n for n in STRUCTURES if n not in ("bvh", "brute")])
def test_every_structure_gives_the_same_bytes(name, expected):
    if STRUCTURES[name].why_not():
        pytest.skip("not on this machine")
    frame = raysvc.render(
        raysvc.load("builtin:shiny"), camera=CAMERA, settings={**SETTINGS, "structure": name}
    )
    for layer, values in expected.layers.items():
        np.testing.assert_array_equal(frame.layers[layer], values)
    assert frame.encode("png") == expected.encode("png")
