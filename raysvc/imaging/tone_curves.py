"""Tone curves: scene-referred light to display light, both linear with Rec.709 primaries.

Every curve takes (3, N) float32, finite and not negative, with the exposure applied, and returns
(3, N) float32 in 0..1. Each is a published formula with its own constants, unchanged.
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from raysvc.types import Floats

ToneCurve = Callable[[Floats], Floats]

# Rec.709 luminance (ITU-R BT.709-6, item 3.2).
LUMINANCE = np.array([[0.2126, 0.7152, 0.0722]], np.float32)


def linear(colour: Floats) -> Floats:
    """Clip at 1."""
    return np.minimum(colour, np.float32(1.0))


# Khronos PBR Neutral, specification in github.com/KhronosGroup/ToneMapping, PBR_Neutral/README.md.
FRESNEL = np.float32(0.04)
COMPRESSION_START = np.float32(0.8) - FRESNEL
DESATURATION = np.float32(0.15)


def pbr_neutral(colour: Floats) -> Floats:
    """Khronos PBR Neutral: base colours come out as they are, only highlights are compressed.

    A grey of 0.08 or more loses the 0.04 that a dielectric reflects under white light; above 0.76
    the peak is compressed hyperbolically towards 1 and desaturated.
    """
    one = np.float32(1.0)
    lowest = colour.min(axis=0)
    offset = np.where(lowest < 2 * FRESNEL, lowest - lowest * lowest / (4 * FRESNEL), FRESNEL)
    based = colour - offset
    peak = based.max(axis=0)
    bright = np.maximum(peak, COMPRESSION_START)
    room = one - COMPRESSION_START
    compressed = one - room * room / (bright + room - COMPRESSION_START)
    kept = one / (DESATURATION * (bright - compressed) + one)
    highlight = based * (compressed / bright * kept) + compressed * (one - kept)
    return np.where(peak < COMPRESSION_START, based, np.minimum(highlight, one))


# AgX by Troy Sobotka with Eary Chow's Rec.2020 base, as Filament (ToneMapper.cpp) and three.js
# (tonemapping_pars_fragment) compute it: the matrices are Blender's, the sigmoid is Benjamin
# Wrensch's polynomial fit (iolite-engine.com, "Minimal AgX implementation"). Rows give outputs.
REC2020_FROM_REC709 = np.array(
    [[0.6274, 0.3293, 0.0433], [0.0691, 0.9195, 0.0113], [0.0164, 0.0880, 0.8956]], np.float32
)
REC709_FROM_REC2020 = np.array(
    [[1.6605, -0.5876, -0.0728], [-0.1246, 1.1329, -0.0083], [-0.0182, -0.1006, 1.1187]],
    np.float32,
)
AGX_INSET = np.array(
    [
        [0.856627153315983, 0.0951212405381588, 0.0482516061458583],
        [0.137318972929847, 0.761241990602591, 0.101439036467562],
        [0.11189821299995, 0.0767994186031903, 0.811302368396859],
    ],
    np.float32,
)
AGX_OUTSET = np.array(
    [
        [1.1271005818144368, -0.11060664309660323, -0.016493938717834573],
        [-0.1413297634984383, 1.157823702216272, -0.016493938717834257],
        [-0.14132976349843826, -0.11060664309660294, 1.2519364065950405],
    ],
    np.float32,
)
AGX_MIN_STOPS, AGX_MAX_STOPS = np.float32(-12.47393), np.float32(4.026069)
AGX_SIGMOID = (15.5, -40.14, 31.96, -6.868, 0.4298, 0.1191, -0.00232)
"""Coefficients from the sixth power down to the constant."""


def agx(colour: Floats) -> Floats:
    """AgX, base look: 16.5 stops through a sigmoid, bright colours desaturating as film does."""
    inset = transformed(transformed(colour, REC2020_FROM_REC709), AGX_INSET)
    stops = np.log2(np.maximum(inset, np.float32(1e-10)))
    x = clipped((stops - AGX_MIN_STOPS) / (AGX_MAX_STOPS - AGX_MIN_STOPS))
    contrast = np.full_like(x, AGX_SIGMOID[0])
    for coefficient in AGX_SIGMOID[1:]:
        contrast = contrast * x + np.float32(coefficient)
    shown = np.maximum(transformed(contrast, AGX_OUTSET), np.float32(0.0)) ** np.float32(2.2)
    return clipped(transformed(shown, REC709_FROM_REC2020))


# Stephen Hill's fit of the ACES 1.0 reference rendering and sRGB output transforms, as published in
# github.com/TheRealMJP/BakingLab, ACES.hlsl. The matrices include the change to AP1 and back.
ACES_INPUT = np.array(
    [[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]],
    np.float32,
)
ACES_OUTPUT = np.array(
    [[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]],
    np.float32,
)


def aces(colour: Floats) -> Floats:
    """Hill's fit of ACES, without the 1/0.6 of exposure that some renderers put before it."""
    v = transformed(colour, ACES_INPUT)
    above = v * (v + np.float32(0.0245786)) - np.float32(0.000090537)
    below = v * (v * np.float32(0.983729) + np.float32(0.4329510)) + np.float32(0.238081)
    fitted: Floats = np.divide(above, below)
    return clipped(transformed(fitted, ACES_OUTPUT))


REINHARD_WHITE = np.float32(4.0)
"""The least luminance that is shown as white."""


def reinhard(colour: Floats) -> Floats:
    """Extended Reinhard on luminance (Reinhard et al. 2002, equation 4); hue kept, then clipped."""
    luminance = transformed(colour, LUMINANCE)[0]
    scale = (1 + luminance / (REINHARD_WHITE * REINHARD_WHITE)) / (1 + luminance)
    return clipped(colour * scale)


def transformed(colour: Floats, matrix: Floats) -> Floats:
    """Return `matrix @ colour`, (M, N) float32, summed in a fixed order.

    Written out because a BLAS may sum differently by the number of rows, and bytes would follow.
    """
    r, g, b = colour
    rows: list[Floats] = [row[0] * r + row[1] * g + row[2] * b for row in matrix]
    return np.stack(rows)


def clipped(colour: Floats) -> Floats:
    """Return the colour limited to 0..1."""
    limited: Floats = np.clip(colour, np.float32(0.0), np.float32(1.0))
    return limited


TONE_CURVES: Mapping[str, ToneCurve] = MappingProxyType(
    {
        "pbr_neutral": pbr_neutral,
        "agx": agx,
        "aces": aces,
        "reinhard": reinhard,
        "linear": linear,
    }
)
"""Every tone map, by the name that settings use."""
