"""What the foreground of a picture hides, guessed from around it where nobody knows better."""

import numpy as np

from raysvc.lens.fill import fill_holes
from raysvc.lens.points import LensPoints
from raysvc.lens.silhouettes import hiding
from raysvc.lens.slices import SHARP_PX, Slices
from raysvc.types import Bools, Longs


def guessed_behind(points: LensPoints, slices: Slices) -> LensPoints:
    """Return the points of a picture, one for each pixel, with others behind them at silhouettes.

    Behind what is nearer than the focus, colour and blur go on from what is not; behind what is in
    focus, from what is farther. Nothing is guessed behind what is far already: there, what its
    neighbours spread is made up to a whole.
    """
    coc = points.coc_px.reshape(points.shape)
    hides = hiding(coc, slices)
    for front, known in (
        (hides & (coc < -SHARP_PX), coc >= -SHARP_PX),
        (hides & (np.abs(coc) < SHARP_PX), coc >= SHARP_PX),
    ):
        pixel = np.flatnonzero(front)
        if len(pixel):
            points = points.behind(_filled(points, pixel, known))
    return points


def _filled(points: LensPoints, pixel: Longs, known: Bools) -> LensPoints:
    """Points in pixels (P,) that go on from what is known (H, W)."""
    first = np.searchsorted(points.pixel, np.arange(known.size))
    values = np.concatenate([points.rgba[first], points.coc_px[first, None]], axis=1)
    picture = values.reshape(*points.shape, 5)
    if not fill_holes(picture, known.astype(np.float32)):
        pixel = pixel[:0]
    found = picture.reshape(-1, 5)[pixel]
    return LensPoints(
        points.shape,
        pixel,
        np.ascontiguousarray(found[:, 4]),
        np.ascontiguousarray(found[:, :4]),
        np.ones(len(pixel), np.float32),
    )
