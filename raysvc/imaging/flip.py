"""FLIP: how different two pictures look that are flipped back and forth on a screen.

Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström and Fairchild 2020, "FLIP: A Difference
Evaluator for Alternating Images" (HPG). Two pipelines: colours, blurred as far as the eye cannot
see detail and compared in a perceptually uniform space; and edges and points, whose differences
raise those of the colours.

The authors' package, `flip-evaluator`, exists for x86-64 alone and for few versions of Python;
this gives its figures (1.7) to 1e-4.
"""

import math
from typing import Final

import numpy as np

from raysvc.errors import InvalidInput
from raysvc.imaging.srgb import linear_from_srgb
from raysvc.imaging.tone_curves import transformed
from raysvc.types import Doubles, Floats

PIXELS_PER_DEGREE: Final = 0.7 * 3840 / 0.7 * math.pi / 180
"""A screen 0.7 m and 3840 pixels wide, seen from 0.7 m: 67.02 pixels in a degree of vision."""

# Section 4.1.1: contrast sensitivity as sums of Gaussians (weight, width), one list per channel.
ACHROMATIC: Final = ((1.0, 0.0047),)
RED_GREEN: Final = ((1.0, 0.0053),)
BLUE_YELLOW: Final = ((34.1, 0.04), (13.5, 0.025))
WIDEST: Final = 0.04

COLOUR_EXPONENT: Final = 0.7
BEND_AT: Final = 0.4
"""Part of the greatest colour difference ..."""
BEND_TO: Final = 0.95
"""... that is shown as this much; what is more shares the rest."""
FEATURE_EXPONENT: Final = 0.5
FEATURE_DEG: Final = 0.082
"""Width of an edge that is easily seen, in degrees of vision: twice the filter's deviation."""

_XYZ_EXACT: Final = np.array(
    [
        [10135552 / 24577794, 8788810 / 24577794, 4435075 / 24577794],
        [2613072 / 12288897, 8788810 / 12288897, 887015 / 12288897],
        [1425312 / 73733382, 8788810 / 73733382, 70074185 / 73733382],
    ]
)
"""XYZ of linear Rec.709 with its D65 white, in the paper's digits."""
_WHITE: Final = _XYZ_EXACT.sum(axis=1, keepdims=True)
XYZ_FROM_LINEAR: Final[Floats] = (_XYZ_EXACT / _WHITE).astype(np.float32)
"""XYZ relative to white."""
LINEAR_FROM_XYZ: Final[Floats] = np.linalg.inv(_XYZ_EXACT / _WHITE).astype(np.float32)


def flip(reference: Floats, test: Floats, pixels_per_degree: float = PIXELS_PER_DEGREE) -> Floats:
    """Compare two pictures as a display shows them.

    Parameters
    ----------
    reference, test
        (H, W, 3) float32 sRGB in 0..1; which is which does not matter
    pixels_per_degree
        of vision; fewer for a viewer who is nearer

    Returns
    -------
    (H, W) float32 in 0..1; its mean is what is usually reported. Raises InvalidInput if the
    pictures are not of one shape.
    """
    if reference.shape != test.shape or reference.ndim != 3 or reference.shape[2] != 3:
        raise InvalidInput(f"cannot compare {reference.shape} and {test.shape}", field="pictures")
    return flip_linear(linear_from_srgb(reference), linear_from_srgb(test), pixels_per_degree)


def flip_linear(reference: Floats, test: Floats, pixels_per_degree: float) -> Floats:
    """`flip` of display-linear pictures (H, W, 3) in 0..1, before the sRGB curve."""
    one, other = _opponent(reference), _opponent(test)
    colour = _colour_difference(one, other, pixels_per_degree)
    feature = _feature_difference(one[0], other[0], pixels_per_degree)
    difference: Floats = colour ** (np.float32(1.0) - feature)
    return difference


def _opponent(linear: Floats) -> Floats:
    """(3, H, W) YCxCz, a linear form of CIELAB, of linear colours (H, W, 3)."""
    x, y, z = transformed(np.moveaxis(linear, 2, 0), XYZ_FROM_LINEAR)
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def _colour_difference(one: Floats, other: Floats, pixels_per_degree: float) -> Floats:
    """(H, W) in 0..1 of two pictures in YCxCz."""
    seen, seen_other = (_lab(_blurred(each, pixels_per_degree)) for each in (one, other))
    difference = _hyab(seen, seen_other) ** np.float32(COLOUR_EXPONENT)
    green, blue = np.eye(3, dtype=np.float32)[1:, :, None, None]
    greatest = float(_hyab(_lab(green), _lab(blue))[0, 0]) ** COLOUR_EXPONENT
    bend = BEND_AT * greatest
    above = BEND_TO + (difference - bend) * ((1 - BEND_TO) / (greatest - bend))
    bent: Floats = np.where(difference < bend, difference * (BEND_TO / bend), above)
    return bent


def _blurred(opponent: Floats, pixels_per_degree: float) -> Floats:
    """(3, H, W) linear colours in 0..1 without the detail that is too fine to be seen."""
    radius = math.ceil(3 * math.sqrt(WIDEST / (2 * math.pi**2)) * pixels_per_degree)
    distance_deg = np.arange(-radius, radius + 1) / pixels_per_degree
    planes = []
    for plane, gaussians in zip(opponent, (ACHROMATIC, RED_GREEN, BLUE_YELLOW), strict=True):
        # A Gaussian in two dimensions is one along x times one along y.
        rows = [
            math.sqrt(a * math.sqrt(math.pi / b)) * np.exp(-((math.pi * distance_deg) ** 2) / b)
            for a, b in gaussians
        ]
        whole = math.sqrt(sum(float(row.sum()) ** 2 for row in rows))
        parts = [_filtered(plane, row / whole, row / whole) for row in rows]
        planes.append(sum(parts[1:], parts[0]))
    y, x_y, y_z = (planes[0] + 16) / 116, planes[1] / 500, planes[2] / 200
    linear = transformed(np.stack([y + x_y, y, y - y_z]), LINEAR_FROM_XYZ)
    clipped: Floats = np.clip(linear, np.float32(0.0), np.float32(1.0))
    return clipped


def _lab(linear: Floats) -> Floats:
    """(3, H, W) CIELAB of linear colours (3, H, W), with Hunt's adjustment: dark colours are
    pale."""
    xyz = transformed(linear, XYZ_FROM_LINEAR)
    delta = 6 / 29
    x, y, z = np.where(xyz > delta**3, np.cbrt(xyz), xyz / (3 * delta**2) + 4 / 29)
    lightness = 116 * y - 16
    return np.stack([lightness, 5 * lightness * (x - y), 2 * lightness * (y - z)])


def _hyab(one: Floats, other: Floats) -> Floats:
    """(H, W) HyAB distance: lightness apart from hue (Abasi, Tehran and Fairchild 2020)."""
    lightness, a, b = one - other
    distance: Floats = np.abs(lightness) + np.sqrt(a * a + b * b)
    return distance


def _feature_difference(one: Floats, other: Floats, pixels_per_degree: float) -> Floats:
    """(H, W) in 0..1 of edges and points of two achromatic planes (H, W)."""
    deviation_px = 0.5 * FEATURE_DEG * pixels_per_degree
    radius = math.ceil(3 * deviation_px)
    distance = np.arange(-radius, radius + 1.0)
    gaussian = np.exp(-0.5 * (distance / deviation_px) ** 2)
    smooth = gaussian / gaussian.sum()
    edge = _balanced(-distance * gaussian)
    point = _balanced(((distance / deviation_px) ** 2 - 1) * gaussian)

    def strength(plane: Floats, across: Doubles) -> Floats:
        grey = (plane + np.float32(16)) / np.float32(116)
        return np.hypot(_filtered(grey, across, smooth), _filtered(grey, smooth, across))

    edges = np.abs(strength(one, edge) - strength(other, edge))
    points = np.abs(strength(one, point) - strength(other, point))
    difference: Floats = (np.maximum(edges, points) * math.sqrt(0.5)) ** FEATURE_EXPONENT
    return difference


def _balanced(taps: Doubles) -> Doubles:
    """Taps scaled so that the positive ones add up to 1 and the negative ones to -1."""
    positive = taps > 0
    scaled: Doubles = np.where(positive, taps / taps[positive].sum(), -taps / taps[~positive].sum())
    return scaled


def _filtered(plane: Floats, across: Doubles, down: Doubles) -> Floats:
    """(H, W) correlated with taps along x and along y; the border repeats beyond itself."""
    return _along_rows(_along_rows(plane.T, down).T, across)


def _along_rows(plane: Floats, taps: Doubles) -> Floats:
    radius, width = len(taps) // 2, plane.shape[1]
    padded = np.pad(plane, ((0, 0), (radius, radius)), mode="edge")
    total = np.zeros_like(plane)
    for start, weight in enumerate(taps.tolist()):
        total += weight * padded[:, start : start + width]
    return total
