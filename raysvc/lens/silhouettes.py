"""Where a lens looks behind what is in front: beside silhouettes, as far as they are blurred."""

import numpy as np

from raysvc.lens.silhouette_kernels import OCTAVES, TILE, mark_hiding, mark_silhouettes
from raysvc.lens.slices import Slices
from raysvc.types import Bools, Floats


def hiding(coc_px: Floats, slices: Slices) -> Bools:
    """Which pixels hide something that is seen through a lens, or may.

    A silhouette is where a pixel's neighbour lies in slices behind all those of the pixel, not just
    across their bound. Within
    reach of the blur of both, pixels that are nearer than the neighbour hide what the lens shows.

    Parameters
    ----------
    coc_px
        (H, W) float32 signed diameters

    Returns
    -------
    (H, W) bool; by tiles of 8 pixels, so rather too many than too few
    """
    height, width = coc_px.shape
    tiles = -(-height // TILE), -(-width // TILE)
    seeds = np.zeros((slices.count, OCTAVES, *tiles), np.bool_)
    bounds = slices.fade_begin, slices.fade_end
    mark_silhouettes(coc_px, *bounds, seeds)
    reached = np.zeros((slices.count, *tiles), np.bool_)
    for k, octave in np.argwhere(seeds.any(axis=(2, 3))):
        reached[k] |= _grown(seeds[k, octave], -(-(2 << int(octave)) // TILE))
    mask = np.zeros(coc_px.shape, np.bool_)
    mark_hiding(coc_px, *bounds, reached, mask)
    return mask


def _grown(mask: Bools, by: int) -> Bools:
    """Mask (H, W) with everything within `by` rows and columns of what is set."""
    for axis in (0, 1):
        size = mask.shape[axis]
        total = np.cumsum(np.moveaxis(mask, axis, 0), axis=0, dtype=np.int32)
        total = np.concatenate([np.zeros_like(total[:1]), total])
        end = np.minimum(np.arange(size) + by + 1, size)
        begin = np.maximum(np.arange(size) - by, 0)
        mask = np.moveaxis(total[end] > total[begin], 0, axis)
    return mask
