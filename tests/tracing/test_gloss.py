"""The mean of rays over neighbours."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from raysvc.tracing.gloss import GATHER, GlossPicture, weight_of_rays
from tests.oracles import gloss as oracle

HEIGHT, WIDTH = 12, 14
UP = np.array([0, 0, 1], np.float32)


def picture(rng, **changes):
    def numbers(low, high, *shape):
        return rng.uniform(low, high, (HEIGHT, WIDTH, *shape)).astype(np.float32)

    made = GlossPicture(
        radiance=numbers(0, 5, 3),
        share=(rng.random((HEIGHT, WIDTH)) < 0.6).astype(np.float32),
        weight=numbers(0.2, 1),
        spread_px=numbers(0, 12),
        roughness=np.full((HEIGHT, WIDTH), 0.3, np.float32),
        depth=np.full((HEIGHT, WIDTH), 2.0, np.float32),
        depth_step=np.full((HEIGHT, WIDTH), 0.1, np.float32),
        normal=np.tile(UP, (HEIGHT, WIDTH, 1)),
    )
    return replace(made, **changes)


def all_of(shown):
    pixel = np.arange(HEIGHT * WIDTH)
    return shown.gathered(
        pixel,
        shown.depth.reshape(-1),
        shown.normal.reshape(-1, 3),
        shown.roughness.reshape(-1),
    )


@settings(deadline=None, max_examples=20)
@given(st.integers(0, 2**32 - 1))
def test_every_pixel_is_the_slow_mean(seed):
    rng = np.random.default_rng(seed)
    normal = rng.normal(size=(HEIGHT, WIDTH, 3)) * 0.2 + UP
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    shown = picture(
        rng,
        share=rng.choice([-1.0, 0.0, 0.5, 1.0], (HEIGHT, WIDTH)).astype(np.float32),
        normal=normal.astype(np.float32),
        roughness=rng.uniform(0.2, 0.4, (HEIGHT, WIDTH)).astype(np.float32),
        depth=rng.uniform(1.9, 2.2, (HEIGHT, WIDTH)).astype(np.float32),
    )
    radiance, share = all_of(shown)
    for n in rng.choice(HEIGHT * WIDTH, 12, replace=False):
        row, col = divmod(int(n), WIDTH)
        expected, met = oracle.gathered(
            shown,
            GATHER,
            row,
            col,
            float(shown.depth[row, col]),
            shown.normal[row, col],
            float(shown.roughness[row, col]),
        )
        assert share[n] == pytest.approx(met, abs=1e-4)
        assert radiance[n] == pytest.approx(expected, rel=1e-3, abs=1e-4)


def test_equal_rays_stay_as_they_are(rng):
    shown = picture(
        rng,
        radiance=np.full((HEIGHT, WIDTH, 3), 2.5, np.float32),
        share=np.full((HEIGHT, WIDTH), 0.7, np.float32),
    )
    radiance, share = all_of(shown)
    assert radiance == pytest.approx(2.5, rel=1e-5) and share == pytest.approx(0.7, rel=1e-5)


def test_what_the_mirror_touches_stays_sharp_and_what_is_far_is_smooth(rng):
    near, _ = all_of(picture(rng, spread_px=np.zeros((HEIGHT, WIDTH), np.float32)))
    shown = picture(rng, spread_px=np.zeros((HEIGHT, WIDTH), np.float32))
    own, _ = all_of(shown)
    met = shown.share.reshape(-1) > 0
    assert (own[met] == shown.radiance.reshape(-1, 3)[met]).all()
    far, _ = all_of(
        picture(
            rng,
            spread_px=np.full((HEIGHT, WIDTH), 30.0, np.float32),
            share=np.ones((HEIGHT, WIDTH), np.float32),
        )
    )
    assert far.std() < 0.25 * near.std()


def test_another_surface_adds_nothing(rng):
    left = np.zeros((HEIGHT, WIDTH), bool)
    left[:, :7] = True
    shown = picture(
        rng,
        radiance=np.where(left[..., None], 1.0, 9.0).astype(np.float32).repeat(3, axis=2),
        share=np.ones((HEIGHT, WIDTH), np.float32),
        spread_px=np.full((HEIGHT, WIDTH), 30.0, np.float32),
        depth=np.where(left, 2.0, 5.0).astype(np.float32),
    )
    radiance, _ = all_of(shown)
    radiance = radiance.reshape(HEIGHT, WIDTH, 3)
    assert radiance[left] == pytest.approx(1.0) and radiance[~left] == pytest.approx(9.0)


def test_rays_in_the_tail_count_by_the_pixels_that_they_reach():
    one = np.ones(3, np.float32)
    middle, tail = np.array([1e-3, 3.0, 300.0], np.float32), np.array([1e-2, 30.0, 3000.0], "f4")
    assert weight_of_rays(one, middle, middle) == pytest.approx(1.0)
    weight = weight_of_rays(one, tail, middle)
    # All of it within a pixel, between, and over a hundred times as many pixels.
    assert weight[0] == pytest.approx(1.0, rel=1e-3)
    assert 0.01 < weight[1] < 0.2
    assert weight[2] == pytest.approx(0.01, rel=1e-2)
