"""Pixels of an OpenEXR file that holds a lat-long map."""

import io
import re
from typing import Any

import numpy as np
import OpenEXR

from raysvc.errors import InvalidEnvironment, LimitExceeded, Unsupported
from raysvc.limits import Limits
from raysvc.types import Floats

MAX_CHANNELS = 64
_NEVER_PRIMARY = ("A", "Z", "depth")


def read_exr(data: bytes, limits: Limits, name: str) -> tuple[Floats, list[str]]:
    """Read RGB, or grey, of the first part.

    OpenEXR's own lat-long map (the attribute `envmap`, ImfEnvmap.h) has +Z in its centre column and
    +X a quarter of the width to the left of it, hence is ours turned by half its width.

    Parameters
    ----------
    data
        the whole file
    limits
        the number of pixels is checked against it before pixels are decoded
    name
        what an error names

    Returns
    -------
    (H, W, 3) float32 in raysvc's orientation, perhaps with negative values or NaN, and warnings

    Raises
    ------
    InvalidEnvironment, Unsupported, LimitExceeded
    """
    header, parts = _header(data, name)
    width, height = _size(header, limits, name)
    warnings = [f"{parts - 1} further parts are not read"] if parts > 1 else []
    chosen = _chosen_channels(header, name)
    if "chromaticities" in header:
        warnings.append("chromaticities are not applied; colours are taken as Rec.709")
    channels = _decoded(data, name)
    planes = []
    for channel in chosen:
        plane = channels[channel]
        if plane.shape != (height, width):
            raise Unsupported(f"channel {channel} is subsampled", name)
        planes.append(np.asarray(plane, np.float32))
    pixels = np.stack(planes if len(planes) == 3 else planes * 3, axis=2)
    if "envmap" in header:
        pixels = np.roll(pixels, width // 2, axis=1)
    return pixels, warnings


def _header(data: bytes, name: str) -> tuple[dict[str, Any], int]:
    try:
        file = OpenEXR.File(io.BytesIO(data), header_only=True, num_threads=0)
        parts = file.parts
        if not parts:
            raise InvalidEnvironment("holds no readable picture", name)
        return dict(parts[0].header), len(parts)
    except InvalidEnvironment:
        raise
    except Exception as error:  # OpenEXR raises RuntimeError, ValueError, UnicodeDecodeError, ...
        raise InvalidEnvironment(_reason(error), name) from None


def _size(header: dict[str, Any], limits: Limits, name: str) -> tuple[int, int]:
    """Check what kind of picture it is and how large, before any pixel is decoded."""
    kind = str(header.get("type", "scanlineimage"))
    if "deep" in kind:
        raise Unsupported("is a deep image; environments need one colour per pixel", name)
    if "CUBE" in str(header.get("envmap", "")):
        raise Unsupported("is a cube map; environments are lat-long maps", name)
    low, high = (np.asarray(corner, np.int64) for corner in header["dataWindow"])
    width, height = (int(side) for side in high - low + 1)
    if width < 1 or height < 1:
        raise InvalidEnvironment("has an empty data window", name)
    if width * height > limits.max_environment_pixels:
        raise LimitExceeded(
            f"{width} x {height} pixels; the limit is {limits.max_environment_pixels:,}", name
        )
    channels = len(header["channels"])
    if channels > MAX_CHANNELS or channels * width * height > 8 * limits.max_environment_pixels:
        raise LimitExceeded(f"{channels} channels of {width} x {height} are too many", name)
    return width, height


def _chosen_channels(header: dict[str, Any], name: str) -> tuple[str, ...]:
    """Channels to read: R, G, B of the main layer or of the first with them; else one for grey."""
    names = [channel.name for channel in header["channels"]]
    if {"RY", "BY"} & set(names):
        raise Unsupported("is in luminance and chroma; environments need RGB", name)
    # The main layer's prefix is empty, and sorts before all others.
    layers = {match[1] for n in names if (match := re.fullmatch(r"((?:.*\.)?)[RGB]", n))}
    for layer in sorted(layers):
        rgb = tuple(layer + colour for colour in "RGB")
        if set(rgb) <= set(names):
            return rgb
    if "Y" in names:
        return ("Y",)
    others = [n for n in names if n not in _NEVER_PRIMARY]
    if len(others) == 1:
        return (others[0],)
    shown = ", ".join(names)[:100]
    raise InvalidEnvironment(f"has neither R, G and B nor Y among its channels ({shown})", name)


def _decoded(data: bytes, name: str) -> dict[str, Any]:
    try:
        file = OpenEXR.File(io.BytesIO(data), separate_channels=True, num_threads=0)
        channels = {key: channel.pixels for key, channel in file.channels().items()}
    except Exception as error:
        raise InvalidEnvironment(_reason(error), name) from None
    if not channels or any(pixels is None for pixels in channels.values()):
        raise InvalidEnvironment("has pixels that cannot be decoded", name)
    return channels


def _reason(error: Exception) -> str:
    return f"cannot be read as OpenEXR ({str(error).strip()[:150]})"
