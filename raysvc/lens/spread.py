"""Depth of field by filter spreading, order 1: every pixel becomes a square as large as its blur.

After Kosloff, Tao and Barsky, "Depth of field postprocessing for layered scenes using constant-time
rectangle spreading" (Graphics Interface 2009): a square is a few differences at its corners, and
two running sums draw all squares at once, so that the cost does not depend on how large they are.
"""

from collections.abc import MutableSequence

import numpy as np

from raysvc.errors import InvalidInput
from raysvc.lens.fill import fill_holes
from raysvc.lens.slices import sliced, square_side_px
from raysvc.lens.spread_kernels import lay_over
from raysvc.lens.squares import Squares, planes
from raysvc.parallel import Control, for_chunks
from raysvc.types import Floats

LARGEST_VALUE = 2.0**40
"""Brighter pixels are limited to it, so that fixed point still resolves 1e-5 beside them."""

KNOWN_PER_WEIGHT = 2.0
"""At a straight silhouette half of the squares are hidden: half the weight is full knowledge."""

ROWS = 32


def spread(
    rgba: Floats,
    coc_px: Floats,
    control: Control | None = None,
    warnings: MutableSequence[str] | None = None,
) -> Floats:
    """Blur a picture as a lens would, given every pixel's circle of confusion.

    Parameters
    ----------
    rgba
        (H, W, 4) float32, linear, premultiplied
    coc_px
        (H, W) float32, signed diameter in pixels, negative nearer than the focus (`lens.coc_px`)
    control
        threads and stopping; the result is the same to the bit with any number of threads
    warnings
        is told if pixels had to be limited

    Returns
    -------
    (H, W, 4) float32; `rgba` itself if nothing is blurred. Sharp pixels (square no larger than a
    pixel) keep their bits unless something nearer is blurred over them.

    Raises InvalidInput if the shapes do not match or a circle of confusion is not finite.
    """
    control = control or Control()
    if rgba.ndim != 3 or rgba.shape[2] != 4 or coc_px.shape != rgba.shape[:2]:
        message = f"(H, W, 4) needs (H, W), got {rgba.shape} and {coc_px.shape}"
        raise InvalidInput(message, field="coc_px")
    if not np.isfinite(coc_px).all():
        raise InvalidInput("must be finite", field="coc_px")
    side = square_side_px(coc_px)
    slices = sliced(coc_px, side)
    if slices.sharp.all():
        return rgba
    rgba = limited(rgba, warnings)
    squares = Squares(planes(rgba), side, control)

    # Back to front: what is behind the focus, what is in focus, what is nearer.
    picture = np.zeros_like(rgba)
    known = np.zeros(side.shape, np.float32)
    for membership in (slices.far, slices.behind):
        if membership is not None:
            _lay(squares.spread(membership), picture, known, control)
    np.copyto(picture, rgba, where=slices.sharp[..., None])
    known[slices.sharp] = 1.0
    if slices.near is not None:
        if fill_holes(picture, known):
            known[:] = 1.0
        _lay(squares.spread(slices.near), picture, known, control)
    return picture


def limited(rgba: Floats, warnings: MutableSequence[str] | None = None) -> Floats:
    """Return rgba with NaN as 0 and the rest within +-LARGEST_VALUE; itself if it is so already."""
    if np.abs(rgba).max() <= LARGEST_VALUE:
        return rgba
    broken = ~(np.abs(rgba) <= LARGEST_VALUE).all(axis=2)
    if warnings is not None:
        warnings.append(f"lens: {broken.sum()} pixels were not finite or brighter than 2^40")
    clean = np.nan_to_num(rgba, nan=0.0, posinf=LARGEST_VALUE, neginf=-LARGEST_VALUE)
    return np.clip(clean, np.float32(-LARGEST_VALUE), np.float32(LARGEST_VALUE))


def _lay(sums: Floats, picture: Floats, known: Floats, control: Control) -> None:
    def work(begin: int, end: int) -> None:
        lay_over(sums, KNOWN_PER_WEIGHT, begin, end, picture, known)

    for_chunks(len(picture), ROWS, work, control)
