"""How far a picture is from the one that it should be, in figures and as a map."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from raysvc.errors import InvalidInput
from raysvc.imaging.encode import over_black
from raysvc.imaging.flip import flip
from raysvc.imaging.hdr_flip import hdr_flip
from raysvc.imaging.tone_map import display8
from raysvc.parallel import Control
from raysvc.types import Bytes, Floats

EPSILON: Final = 1e-2
"""Added to the squared reference, so that what is nearly black does not decide."""
WORST_PART: Final = 1e-3
"""Of the pixels, that a trimmed mean leaves out: a few that a path tracer has hardly ever found the
light for would decide otherwise."""


@dataclass(frozen=True, slots=True)
class DifferenceFigures:
    """A picture against its reference, in numbers."""

    flip: float
    """Mean FLIP of the pictures as displayed, tone mapped and in 8 bits, at 67 pixels per degree:
    that of the two files that a viewer sees. 0 is alike, 1 is as unlike as can be."""
    hdr_flip: float
    """Mean HDR-FLIP, which needs no tone map."""
    rel_mse: float
    """Mean over pixels and channels of (picture - reference)^2 / (reference^2 + EPSILON)."""
    rel_mse_trimmed: float
    """The same without the worst WORST_PART of the pixels."""
    mean_ratio: float | None
    """The picture's mean over the reference's: more than 1 is too bright. None beside black."""


@dataclass(frozen=True, slots=True, eq=False)
class PictureDifference:
    """Figures, and what belongs to them by pixel: (H, W) with row 0 at the top."""

    figures: DifferenceFigures
    flip_map: Floats
    """(H, W) 0..1, whose mean is `figures.flip`."""
    picture: Bytes
    """(H, W, 3) as displayed."""
    reference: Bytes


def picture_difference(
    picture: Floats,
    reference: Floats,
    tone_map: str,
    exposure_stops: float = 0.0,
    control: Control | None = None,
) -> PictureDifference:
    """Compare two linear scene-referred pictures.

    Parameters
    ----------
    picture, reference
        (H, W, 4) float32, premultiplied by alpha, as `beauty` of a frame; what is transparent is
        compared as black
    tone_map, exposure_stops
        how both are displayed

    Raises InvalidInput if they are not of one shape, or hold something that is not a number;
    InvalidSetting for an unknown tone map.
    """
    if picture.shape != reference.shape or picture.ndim != 3 or picture.shape[2] != 4:
        raise InvalidInput(f"cannot compare {picture.shape} and {reference.shape}", "pictures")
    if not (np.isfinite(picture).all() and np.isfinite(reference).all()):
        raise InvalidInput("hold pixels that are not finite", "pictures")
    control = control or Control()
    shown, truth = (
        over_black(display8(each, tone_map, exposure_stops, control))
        for each in (picture, reference)
    )
    white = np.float32(255)
    flip_map = flip(truth.astype(np.float32) / white, shown.astype(np.float32) / white)
    linear, true = (np.ascontiguousarray(each[..., :3]) for each in (picture, reference))
    errors = hdr_flip(true, linear, control=control).errors
    squares = (linear.astype(np.float64) - true) ** 2 / (true.astype(np.float64) ** 2 + EPSILON)
    by_pixel = np.sort(squares.mean(axis=2), axis=None)
    kept = by_pixel[: len(by_pixel) - int(WORST_PART * len(by_pixel))]
    mean = float(true.mean(dtype=np.float64))
    figures = DifferenceFigures(
        flip=float(flip_map.mean(dtype=np.float64)),
        hdr_flip=float(errors.mean(dtype=np.float64)),
        rel_mse=float(by_pixel.mean()),
        rel_mse_trimmed=float(kept.mean()),
        mean_ratio=float(linear.mean(dtype=np.float64)) / mean if mean > 0 else None,
    )
    return PictureDifference(figures, flip_map, shown, truth)
