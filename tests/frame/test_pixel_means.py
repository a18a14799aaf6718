"""Small mirrors of a detailed environment, without anti-aliasing, beside reference mode."""

import numpy as np
import pytest

from raysvc.frame.render import render
from raysvc.scene import Environment, Material
from tests.frame.subjects import ball

VIEW = {"eye": [0, 0, 9], "target": [0, 0, 0], "fov_y_deg": 40.0, "width": 40, "height": 40}


@pytest.mark.parametrize("roughness", [0.0, 0.06])
def test_a_ball_of_a_few_pixels_shows_their_means(rng, roughness):
    texels = rng.random((128, 256, 3)).astype(np.float32) ** 3
    scene = ball(Material(metallic=1.0, roughness=roughness))

    def shown(**settings):
        frame = render(scene, Environment(texels), VIEW, {"aa": "none", "lens": "none", **settings})
        return frame.layers["beauty"][..., 0], frame.layers["id"] >= 0

    picture, seen = shown()
    truth, _ = shown(mode="reference", samples=512)
    inner = seen.copy()
    for axis in (0, 1):
        for step in (-2, -1, 1, 2):
            inner &= np.roll(seen, step, axis)
    error = np.abs(picture - truth)[inner].mean() / truth[inner].mean()
    # Texels that are looked up at points are off by as much as they differ: by 90 % here.
    assert error < 0.15
