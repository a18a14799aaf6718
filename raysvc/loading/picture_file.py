"""Pictures and their depth from files of any renderer: OpenEXR, PNG (JPEG, WebP) and NumPy's NPZ.

    picture   EXR   R G B and perhaps A: linear, premultiplied
              NPZ   `beauty`, or the one array of three or four channels: linear, premultiplied
              PNG   sRGB, straight alpha, of 8 bits
    depth     EXR   depth.Z, Z or depth, or else the only channel: metres
              NPZ   `depth`, or the one array of one channel: metres
              PNG   grey of 8 or 16 bits, times `depth_scale_m`; 0 is the background

Depth is measured along the view axis; inf is the background. So an EXR or NPZ that raysvc has
written is both.
"""

import dataclasses
import io
import warnings
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import OpenEXR
from PIL import Image

from raysvc.errors import InvalidInput, LimitExceeded, RaysvcError
from raysvc.limits import DEFAULT_LIMITS, Limits
from raysvc.loading.archive import unpack
from raysvc.loading.images import decode_image
from raysvc.loading.npy_file import npy_array
from raysvc.types import Floats

EXR_MAGIC, ZIP_MAGIC, PNG_MAGIC = b"\x76\x2f\x31\x01", b"PK", b"\x89PNG"
MAX_CHANNELS = 128
DEPTH_CHANNELS = ("depth.Z", "Z", "depth", "depth.V")


class StoredPicture(NamedTuple):
    """A picture as its file has it."""

    rgba: Floats
    """(H, W, 4) float32, perhaps with pixels that are not finite."""
    coded: bool
    """sRGB with straight alpha, in 0..1; else linear Rec.709, premultiplied."""


def read_picture(
    data: bytes, limits: Limits = DEFAULT_LIMITS, field: str = "picture"
) -> StoredPicture:
    """Read a picture. Raises InvalidInput, LimitExceeded."""
    if data.startswith(EXR_MAGIC):
        channels = _exr(data, limits, field)
        if not {"R", "G", "B"} <= channels.keys():
            raise InvalidInput(f"has no R, G and B among {_names(channels)}", field)
        alpha = channels.get("A", np.ones_like(channels["R"]))
        rgba = np.stack([channels["R"], channels["G"], channels["B"], alpha], axis=2)
        return StoredPicture(rgba, False)
    if data.startswith(ZIP_MAGIC):
        array = _npz(data, limits, field, "beauty", (3, 4))
        if array.shape[2] == 3:
            array = np.concatenate([array, np.ones_like(array[..., :1])], axis=2)
        return StoredPicture(array, False)
    return StoredPicture(_decoded(data, limits, field).astype(np.float32) / np.float32(255), True)


def read_depth(
    data: bytes,
    limits: Limits = DEFAULT_LIMITS,
    depth_scale_m: float | None = None,
    field: str = "depth",
) -> Floats:
    """Return (H, W) float32 metres, inf for the background. Raises InvalidInput, LimitExceeded."""
    if data.startswith(EXR_MAGIC):
        depth = _only_depth(_exr(data, limits, field), field)
    elif data.startswith(ZIP_MAGIC):
        depth = _npz(data, limits, field, "depth", (1,))[..., 0]
    else:
        if depth_scale_m is None:
            raise InvalidInput("needs depth_scale_m, the metres of one step of grey", field)
        grey = _grey(data, limits, field)
        depth = np.where(grey > 0, grey * np.float32(depth_scale_m), np.float32(np.inf))
    if not (depth > 0).all():
        raise InvalidInput("must be more than 0, or inf for the background, everywhere", field)
    return np.ascontiguousarray(depth, np.float32)


def holds_depth(data: bytes) -> bool:
    """Can a picture's file hold depth as well?"""
    return data.startswith((EXR_MAGIC, ZIP_MAGIC))


def _only_depth(channels: Mapping[str, Floats], field: str) -> Floats:
    for name in DEPTH_CHANNELS:
        if name in channels:
            return channels[name]
    if len(channels) != 1:
        raise InvalidInput(f"has none of {', '.join(DEPTH_CHANNELS)}: {_names(channels)}", field)
    return next(iter(channels.values()))


def _exr(data: bytes, limits: Limits, field: str) -> dict[str, Floats]:
    """All channels of the first part, (H, W) float32."""
    try:
        file = OpenEXR.File(io.BytesIO(data), header_only=True, num_threads=0)
        header: dict[str, Any] = dict(file.parts[0].header)
        low, high = (np.asarray(corner, np.int64) for corner in header["dataWindow"])
        width, height = (int(side) for side in high - low + 1)
        count = len(header["channels"])
    except Exception as error:  # OpenEXR raises RuntimeError, ValueError, UnicodeDecodeError, ...
        raise InvalidInput(_reason(error), field) from None
    if "deep" in str(header.get("type", "")):
        raise InvalidInput("is a deep image; one value per pixel is needed", field)
    _check_size(width, height, limits, field)
    if count > MAX_CHANNELS:
        raise LimitExceeded(f"{count} channels; the limit is {MAX_CHANNELS}", field)
    try:
        file = OpenEXR.File(io.BytesIO(data), separate_channels=True, num_threads=0)
        found = {name: channel.pixels for name, channel in file.channels().items()}
    except Exception as error:
        raise InvalidInput(_reason(error), field) from None
    whole = {
        name: np.asarray(pixels, np.float32)
        for name, pixels in found.items()
        if pixels is not None and pixels.shape == (height, width)
    }
    if not whole:
        raise InvalidInput("has no channels that could be decoded", field)
    return whole


def _npz(data: bytes, limits: Limits, field: str, name: str, channels: tuple[int, ...]) -> Floats:
    """(H, W, C) float32 of the array of that name, or of the only one of a fitting shape."""
    most = limits.max_image_pixels * 64
    bounds = dataclasses.replace(
        limits, max_files=64, max_file_bytes=most, max_scene_bytes=2 * most
    )
    try:
        files = unpack(data, bounds)
    except LimitExceeded as error:
        raise LimitExceeded(error.message, field) from None
    except RaysvcError as error:
        raise InvalidInput(error.message, field) from None
    arrays = {}
    for path, content in files.items():
        if not path.endswith(".npy"):
            raise InvalidInput(f"holds {ascii(path)[:120]}; known are .npy arrays", field)
        try:
            array = npy_array(content)
        except ValueError as error:
            raise InvalidInput(f"{ascii(path)[:120]} {error}", field) from None
        if array.ndim == 2:
            array = array[..., None]
        if array.ndim == 3 and array.shape[2] in channels and array.size:
            arrays[path.removesuffix(".npy")] = array
    chosen = arrays.get(name)
    if chosen is None and len(arrays) == 1:
        chosen = next(iter(arrays.values()))
    if chosen is None:
        wanted = " or ".join(str(count) for count in channels)
        raise InvalidInput(f"has no {name}, nor one array alone of {wanted} channels", field)
    _check_size(chosen.shape[1], chosen.shape[0], limits, field)
    return chosen.astype(np.float32)


def _decoded(data: bytes, limits: Limits, field: str) -> np.ndarray[Any, np.dtype[np.uint8]]:
    try:
        return decode_image(data, limits.max_image_pixels, field)
    except LimitExceeded:
        raise
    except RaysvcError as error:
        raise InvalidInput(f"{error.message}, nor EXR or NPZ", field) from None


def _grey(data: bytes, limits: Limits, field: str) -> Floats:
    if not data.startswith(PNG_MAGIC):
        raise InvalidInput("is none of EXR, NPZ and PNG", field)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with Image.open(io.BytesIO(data), formats=("PNG",)) as image:
                _check_size(image.width, image.height, limits, field)
                if image.mode not in ("L", "I", "I;16", "I;16B"):
                    raise InvalidInput(f"must be grey of 8 or 16 bits, is {image.mode}", field)
                return np.asarray(image).astype(np.float32)
    except RaysvcError:
        raise
    except Exception as error:  # damaged files make decoders raise nearly everything
        raise InvalidInput(f"cannot be decoded: {str(error)[:100]}", field) from None


def _check_size(width: int, height: int, limits: Limits, field: str) -> None:
    if width < 1 or height < 1:
        raise InvalidInput("is empty", field)
    if max(width, height) > limits.max_image_side or width * height > limits.max_image_pixels:
        raise LimitExceeded(
            f"{width} x {height} pixels; the limit is {limits.max_image_pixels:,}, and "
            f"{limits.max_image_side} on either side",
            field,
        )


def _names(channels: Mapping[str, Floats]) -> str:
    return ", ".join(sorted(channels))[:100]


def _reason(error: Exception) -> str:
    return f"cannot be read as OpenEXR ({str(error).strip()[:150]})"
