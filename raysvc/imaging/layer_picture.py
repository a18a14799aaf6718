"""Layers made visible: any layer of a frame as an 8-bit sRGB picture for people to look at."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from raysvc.errors import InvalidInput
from raysvc.imaging.srgb import srgb_from_linear
from raysvc.types import Bytes, Floats, Ints

NEAREST_GREY = np.float32(1.0)
FARTHEST_GREY = np.float32(0.1)


def layer_picture(name: str, array: NDArray[Any]) -> Bytes:
    """Return (H, W, 3) uint8 of a layer.

    `depth` (H, W): nearest white to farthest dark grey, nothing black. `normal` and `bent_normal`
    (H, W, 3): 0.5 + 0.5 n. `id`, or any whole numbers (H, W): a fixed colour per number, negative
    black. Any other (H, W): smallest black to largest white. Any other (H, W, 3|4): linear colour,
    clipped, sRGB.
    Raises InvalidInput for any other shape.
    """
    if array.ndim == 2 and array.dtype.kind in "iu":
        return hashed_colours(array)
    if name == "depth" and array.ndim == 2:
        return _eight_bit(_grey(array, FARTHEST_GREY, NEAREST_GREY, descending=True))
    if name in ("normal", "bent_normal") and array.ndim == 3 and array.shape[2] == 3:
        return _eight_bit(np.float32(0.5) + np.float32(0.5) * array)
    if array.ndim == 2:
        return _eight_bit(_grey(array, np.float32(0.0), np.float32(1.0), descending=False))
    if array.ndim == 3 and array.shape[2] in (3, 4):
        colour = np.nan_to_num(array[..., :3], nan=0.0, posinf=1.0)
        return _eight_bit(srgb_from_linear(np.clip(colour, 0.0, 1.0)))
    raise InvalidInput(f"cannot show an array of shape {array.shape}", field=name)


def hashed_colours(ids: Ints) -> Bytes:
    """Return (H, W, 3) uint8: a colour by number, unlike its neighbours'; negative black.

    The mixing is MurmurHash3's 32-bit finaliser (Appleby 2011).
    """
    h = ids.astype(np.uint32) + np.uint32(0x9E3779B9)
    h ^= h >> np.uint32(16)
    h *= np.uint32(0x85EBCA6B)
    h ^= h >> np.uint32(13)
    h *= np.uint32(0xC2B2AE35)
    h ^= h >> np.uint32(16)
    colours = np.stack([h >> np.uint32(shift) & np.uint32(0xFF) for shift in (0, 8, 16)], axis=-1)
    visible = (64 + colours * np.uint32(191) // np.uint32(255)).astype(np.uint8)
    return np.where((ids < 0)[..., None], np.uint8(0), visible)


def _grey(values: Floats, first: np.float32, last: np.float32, descending: bool) -> Floats:
    finite = np.isfinite(values)
    if not finite.any():
        return np.zeros((*values.shape, 3), np.float32)
    low, high = values[finite].min(), values[finite].max()
    place = (values - low) / max(high - low, np.float32(1e-20))
    place = np.where(finite, 1 - place if descending else place, 0)
    grey = np.where(finite, first + (last - first) * place, 0)
    return np.repeat(grey.astype(np.float32)[..., None], 3, axis=2)


def _eight_bit(shown: Floats) -> Bytes:
    codes: Bytes = np.rint(np.clip(np.nan_to_num(shown), 0.0, 1.0) * 255.0).astype(np.uint8)
    return codes
