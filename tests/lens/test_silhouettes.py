"""Where a lens looks behind things: nothing that it needs is left out."""

import numpy as np
import pytest

from raysvc.lens.guess import guessed_behind
from raysvc.lens.points import LensPoints
from raysvc.lens.silhouette_kernels import STEP_PX
from raysvc.lens.silhouettes import hiding
from raysvc.lens.slices import slices_for
from tests.lens.pictures import random_picture


def needed(coc, slices):
    """(H, W) bool, pixel by pixel: nearer than what is behind a silhouette within reach."""
    height, width = coc.shape
    beyond = slices.beyond(coc)
    mask = np.zeros(coc.shape, bool)
    rows, columns = np.mgrid[:height, :width]
    for y in range(height):
        for x in range(width):
            for v, u in ((y + 1, x), (y, x + 1), (y - 1, x), (y, x - 1)):
                if not (0 <= v < height and 0 <= u < width):
                    continue
                if coc[v, u] >= max(beyond[y, x], coc[y, x] + STEP_PX):
                    reach = (abs(coc[y, x]) + abs(coc[v, u])) / 2
                    near = np.hypot(rows - y, columns - x) <= reach
                    mask |= near & (beyond <= coc[v, u])
    return mask


@pytest.mark.parametrize("blurs", [(-20.0, 0.0), (0.0, 15.0), (-9.0, 30.0), (3.0, 12.0)])
def test_all_pixels_within_reach_of_a_silhouette_are_found(blurs, rng):
    near, far = blurs
    slices = slices_for(-32.0, 32.0)
    coc = np.full((60, 90), far, np.float32)
    coc[20:45, 30:60] = near
    found = hiding(coc, slices)
    assert np.all(found[needed(coc, slices)])
    assert not found[coc == far].any()
    assert found.sum() > 0


def test_a_surface_that_recedes_has_no_silhouettes():
    coc = np.broadcast_to(np.linspace(-60, 60, 300, dtype=np.float32), (40, 300)).copy()
    assert not hiding(coc, slices_for(-60.0, 60.0)).any()


def test_the_inside_of_something_large_hides_nothing_that_matters():
    coc = np.full((200, 200), 0.0, np.float32)
    coc[20:180, 20:180] = -10.0
    found = hiding(coc, slices_for(-10.0, 0.0))
    assert found[25, 100] and not found[100, 100]


def test_what_is_guessed_goes_on_from_what_is_behind(rng):
    rgba = random_picture(rng, 48, 64)
    rgba[:, 32:, :3] = (0.1, 0.2, 0.3)
    coc = np.zeros((48, 64), np.float32)
    coc[:, :32] = -12.0
    points = guessed_behind(LensPoints.of_picture(rgba, coc), slices_for(-12.0, 0.0))
    behind = np.flatnonzero(np.diff(points.pixel, prepend=-1) == 0)
    assert len(behind) > 0
    assert np.all(points.pixel[behind] % 64 < 32)
    assert np.allclose(points.rgba[behind], [0.1, 0.2, 0.3, 1.0], atol=1e-5)
    assert np.allclose(points.coc_px[behind], 0.0)
