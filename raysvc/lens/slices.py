"""Which pixels are spread together: the picture cut into slices by signed circle of confusion.

What is far behind the focus must not wash over what is nearer, so slices are spread apart and laid
over each other back to front. Membership is soft between the two slices behind the focus, and the
memberships of a pixel sum to one: a surface that recedes has no seam between slices.
"""

from dataclasses import dataclass

import numpy as np

from raysvc.types import Bools, Floats

SIDE_PER_DIAMETER = np.sqrt(3.0) / 2.0
"""A square of this side has the variance of a disc of diameter 1: side^2 / 12 = diameter^2 / 16."""

SHARP_SIDE_PX = 1.0
"""A square no larger than the pixel spreads nothing."""

FAR_BEGINS_PX, FAR_ENDS_PX = 4.0, 16.0
"""Sides between which a pixel behind the focus passes from slice `behind` to slice `far`."""


@dataclass(frozen=True, slots=True, eq=False)
class Slices:
    """Memberships, (H, W) float32 in 0..1 or None where the whole slice is empty; back to front."""

    far: Floats | None
    behind: Floats | None
    sharp: Bools
    near: Floats | None


def square_side_px(coc_px: Floats) -> Floats:
    """Return the side of every pixel's square, (H, W) float32, for signed diameters (H, W).

    It is limited to twice the smaller side of the picture: such a square covers that side already.
    """
    largest = 2.0 * min(coc_px.shape)
    side: Floats = np.minimum(np.abs(coc_px) * np.float32(SIDE_PER_DIAMETER), np.float32(largest))
    return side


def sliced(coc_px: Floats, side_px: Floats) -> Slices:
    """Cut a picture by signed diameters and sides of squares, both (H, W) float32."""
    sharp = side_px <= SHARP_SIDE_PX
    beyond = ~sharp & (coc_px > 0)
    octaves = np.log2(np.maximum(side_px, np.float32(SHARP_SIDE_PX)) / np.float32(FAR_BEGINS_PX))
    passed = np.clip(octaves / np.log2(FAR_ENDS_PX / FAR_BEGINS_PX), 0.0, 1.0)
    share: Floats = passed.astype(np.float32)
    return Slices(
        far=_or_none(np.where(beyond, share, np.float32(0.0))),
        behind=_or_none(np.where(beyond, np.float32(1.0) - share, np.float32(0.0))),
        sharp=sharp,
        near=_or_none((~sharp & (coc_px < 0)).astype(np.float32)),
    )


def _or_none(membership: Floats) -> Floats | None:
    return membership if membership.any() else None
