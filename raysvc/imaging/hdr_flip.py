"""HDR-FLIP: the greatest FLIP over all exposures at which a picture may be looked at.

Andersson, Nilsson, Shirley and Akenine-Möller 2021, "Visualizing Errors in Rendered High Dynamic
Range Images" (Eurographics Short Papers). It needs no tone map to be chosen: an error that hides
in the dark or in what is blown out at one exposure shows at another.
"""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from raysvc.errors import InvalidInput
from raysvc.imaging.flip import PIXELS_PER_DEGREE, flip_linear
from raysvc.imaging.tone_curves import LUMINANCE
from raysvc.parallel import Control, map_chunks
from raysvc.types import Floats

SHOWN_AS: Final = 0.85
"""Of a display's white: the exposures reach from the brightest pixel that is shown so to the median
that is."""

# Narkowicz 2016, "ACES Filmic Tone Mapping Curve", with its factor of 0.6 for the exposure.
ABOVE: Final = (0.6 * 0.6 * 2.51, 0.6 * 0.03, 0.0)
BELOW: Final = (0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14)


@dataclass(frozen=True, slots=True, eq=False)
class HdrFlip:
    """How different two pictures look at the exposures that tell them apart best."""

    errors: Floats
    """(H, W) in 0..1."""
    exposures_stops: tuple[float, ...]
    """At which they were compared."""


def hdr_flip(
    reference: Floats,
    test: Floats,
    pixels_per_degree: float = PIXELS_PER_DEGREE,
    control: Control | None = None,
) -> HdrFlip:
    """Compare two linear scene-referred pictures (H, W, 3) float32 of any range.

    Exposures follow from the reference. Negative values count as 0. Raises InvalidInput if the
    pictures are not of one shape.
    """
    if reference.shape != test.shape or reference.ndim != 3 or reference.shape[2] != 3:
        raise InvalidInput(f"cannot compare {reference.shape} and {test.shape}", field="pictures")
    one, other = (np.maximum(each, np.float32(0.0)) for each in (reference, test))
    exposures = exposures_of(one)

    def at(begin: int, end: int) -> Floats:
        gain = np.float32(2.0 ** exposures[begin])
        return flip_linear(filmic(one * gain), filmic(other * gain), pixels_per_degree)

    errors = map_chunks(len(exposures), 1, at, control or Control(), "comparing exposures")
    return HdrFlip(np.maximum.reduce(errors), exposures)


def exposures_of(reference: Floats) -> tuple[float, ...]:
    """Stops from where the brightest pixel is not blown out to where the median is bright.

    As in the paper, about one stop apart and at least two; but pixels without any light do not
    count, so that a picture that is mostly black has exposures too.
    """
    light = reference @ LUMINANCE[0]
    light = light[light > 0]
    if not len(light):
        return (0.0,)
    a, b, c = (up - SHOWN_AS * down for up, down in zip(ABOVE, BELOW, strict=True))
    bright = (-b + math.sqrt(b * b - 4 * a * c)) / (2 * a)
    median = np.partition(light, len(light) // 2)[len(light) // 2]
    first, last = (math.log2(bright / float(value)) for value in (light.max(), median))
    return tuple(np.linspace(first, last, max(2, math.ceil(last - first))).tolist())


def filmic(exposed: Floats) -> Floats:
    """Tone map any colours >= 0 to 0..1."""
    # Beyond this the curve is flat, and its squares would not be finite.
    x = np.minimum(exposed, np.float32(1e6))
    above = (ABOVE[0] * x + ABOVE[1]) * x
    below = (BELOW[0] * x + BELOW[1]) * x + BELOW[2]
    shown: Floats = np.minimum(above / below, np.float32(1.0))
    return shown
