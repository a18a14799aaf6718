"""Kernels that lay slices over each other, from front to back."""

import numpy as np

from raysvc.jit import kernel
from raysvc.types import Floats


@kernel
def lay_behind(
    spread: Floats,
    drawn: bool,
    hidden: bool,
    picture: Floats,
    open_: Floats,
    open_before: Floats,
) -> None:
    """Lay a spread slice behind what there is.

    spread: (R, W, CHANNELS) sums of what was spread, zero on return; looked at only if anything was
    `drawn`. picture: (R, W, 4) premultiplied, added to. open_: (R, W) part of each pixel that is
    not covered yet. open_before: the same without the last slice. All float32. hidden: what was
    spread is what is hidden of the slice that was laid last.

    Slices cover independently of each other, as in Porter and Duff 1984, but for this: a surface
    that recedes goes on from one slice to the next, and there each covers just what the other
    leaves. So of two slices next to each other, what no pixel has behind something counts as beside
    it.
    """
    rows, width, _ = picture.shape
    for y in range(rows):
        if not drawn:
            if not hidden:
                open_before[y] = open_[y]
            continue
        for x in range(width):
            cover = spread[y, x, 4]
            open_here, before = open_[y, x], open_before[y, x]
            if not hidden:
                open_before[y, x] = open_here
            if cover > 0.0 and open_here > 0.0:
                beside = min(max(spread[y, x, 5], np.float32(0.0)), cover)
                # Where points meet that spread differently there may be more than all.
                taken = min(open_here, (cover - beside) * open_here + beside * before)
                share = taken / cover
                for c in range(4):
                    picture[y, x, c] += share * spread[y, x, c]
                open_[y, x] = open_here - taken
        spread[y] = 0.0


@kernel
def lay_focus_behind(focus: Floats, picture: Floats, open_: Floats, open_before: Floats) -> None:
    """Lay behind what is in focus: (R, W, 5) premultiplied colour and how much it covers."""
    rows, width, _ = picture.shape
    for y in range(rows):
        for x in range(width):
            here, cover = open_[y, x], focus[y, x, 4]
            open_before[y, x] = here
            if cover <= 0.0:
                continue
            for c in range(4):
                picture[y, x, c] += here * focus[y, x, c]
            open_[y, x] = here - here * cover


@kernel
def make_whole(picture: Floats, open_: Floats) -> None:
    """Divide by what is covered, where nothing is known of the rest; in place.

    What is covered to within rounding is left as it is, to the bit.
    """
    rows, width, _ = picture.shape
    for y in range(rows):
        for x in range(width):
            covered = np.float32(1.0) - open_[y, x]
            if covered < 1.0 and covered > 0.0:
                for c in range(4):
                    picture[y, x, c] /= covered
