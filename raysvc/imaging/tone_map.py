"""From a rendered picture to what a display shows: exposure, tone curve, sRGB, 8 or 16 bits."""

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from raysvc.errors import InvalidSetting
from raysvc.imaging.srgb import srgb_from_linear
from raysvc.imaging.tone_curves import TONE_CURVES, clipped
from raysvc.parallel import Control, for_chunks
from raysvc.types import Bytes, Floats

Words: TypeAlias = NDArray[np.uint16]

CHUNK_PIXELS = 1 << 16
"""Fixed, so that the bytes do not depend on the number of threads; the temporaries fit a cache."""

BRIGHTEST = np.float32(1e8)
"""Every curve is white long before; keeps infinities and products of large numbers out of them."""


def display8(
    picture: Floats, tone_map: str, exposure_stops: float = 0.0, control: Control | None = None
) -> Bytes:
    """Return (H, W, 3|4) uint8 sRGB of a (H, W, 3|4) linear picture. See `display`."""
    out = np.empty(picture.shape, np.uint8)
    _quantise(picture, out, tone_map, exposure_stops, control or Control())
    return out


def display16(
    picture: Floats, tone_map: str, exposure_stops: float = 0.0, control: Control | None = None
) -> Words:
    """Return (H, W, 3|4) uint16 sRGB of a (H, W, 3|4) linear picture. See `display`."""
    out = np.empty(picture.shape, np.uint16)
    _quantise(picture, out, tone_map, exposure_stops, control or Control())
    return out


def display(pixels: Floats, tone_map: str, exposure_stops: float = 0.0) -> Floats:
    """Tone map and sRGB-encode pixels.

    Parameters
    ----------
    pixels
        (N, 3) float32 linear scene-referred Rec.709, or (N, 4) with colour premultiplied by alpha.
        Negative and undefined components count as 0.
    tone_map
        a name in TONE_CURVES; anything else raises InvalidSetting
    exposure_stops
        the colour is multiplied by two to this power

    Returns
    -------
    (N, 3|4) float32 in 0..1, sRGB-encoded; alpha is straight, as PNG and WebP have it
    """
    curve = TONE_CURVES.get(tone_map)
    if curve is None:
        known = ", ".join(TONE_CURVES)
        raise InvalidSetting(f"must be one of {known} (got {tone_map!r})", field="tone_map")
    out = np.empty_like(pixels)
    colour = np.ascontiguousarray(pixels[:, :3].T)
    if pixels.shape[1] == 4:
        alpha = clipped(np.nan_to_num(pixels[:, 3]))
        # A curve bends premultiplied colour wrongly at soft edges, so it is divided out first.
        colour = np.divide(colour, alpha, out=np.zeros_like(colour), where=alpha > 0)
        out[:, 3] = alpha
    with np.errstate(over="ignore", invalid="ignore"):
        exposed = colour * np.float32(2.0**exposure_stops)
    exposed = np.clip(np.nan_to_num(exposed), np.float32(0.0), BRIGHTEST)
    out[:, :3] = srgb_from_linear(curve(exposed)).T
    return out


def _quantise(
    picture: Floats, out: Bytes | Words, tone_map: str, exposure_stops: float, control: Control
) -> None:
    channels = picture.shape[2]
    pixels, codes = picture.reshape(-1, channels), out.reshape(-1, channels)
    largest = np.float32(np.iinfo(out.dtype).max)

    def work(begin: int, end: int) -> None:
        shown = display(pixels[begin:end], tone_map, exposure_stops)
        codes[begin:end] = np.rint(shown * largest)

    for_chunks(len(pixels), CHUNK_PIXELS, work, control)
