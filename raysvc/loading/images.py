"""Decoding pictures for textures: 8-bit RGBA, with the number of pixels checked before decoding."""

import io
import struct
import warnings

import numpy as np
from PIL import Image, UnidentifiedImageError

from raysvc.errors import InvalidScene, LimitExceeded
from raysvc.types import Bytes

TEXTURE_FORMATS = ("PNG", "JPEG", "WEBP")


def decode_image(
    data: bytes | memoryview,
    max_pixels: int,
    field: str,
    formats: tuple[str, ...] = TEXTURE_FORMATS,
) -> Bytes:
    """Decode one picture; colour profiles and orientation tags are ignored, as glTF wants.

    Parameters
    ----------
    data
        the whole file
    max_pixels
        largest width times height
    field
        what an error names, such as `images[2]`
    formats
        names of Pillow's formats that are tried

    Returns
    -------
    (H, W, 4) uint8 RGBA, row 0 at the top

    Raises
    ------
    InvalidScene
        not one of these formats, or damaged
    LimitExceeded
        too many pixels
    """
    data = bytes(data)
    _check_webp(data, max_pixels, field)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with Image.open(io.BytesIO(data), formats=formats) as image:
                _check_size(image.width, image.height, max_pixels, field)
                return _rgba(image)
    except Image.DecompressionBombError:
        raise LimitExceeded(f"the limit is {max_pixels:,} pixels", field) from None
    except UnidentifiedImageError:
        raise InvalidScene(f"is none of {', '.join(formats)}", field) from None
    except MemoryError:
        raise LimitExceeded("does not fit into memory", field) from None
    except LimitExceeded:
        raise
    except Exception as error:  # damaged files make decoders raise nearly everything
        raise InvalidScene(f"cannot be decoded: {str(error)[:100]}", field) from None


def _rgba(image: Image.Image) -> Bytes:
    if image.mode.startswith("I"):
        grey = np.asarray(image).astype(np.int64)
        level = np.clip((grey * 255 + 32767) // 65535, 0, 255).astype(np.uint8)
        opaque = np.full_like(level, 255)
        return np.stack([level, level, level, opaque], axis=2)
    return np.array(image.convert("RGBA"), np.uint8)


def _check_size(width: int, height: int, max_pixels: int, field: str) -> None:
    if width * height > max_pixels:
        raise LimitExceeded(f"{width} x {height} pixels; the limit is {max_pixels:,}", field)


def _check_webp(data: bytes, max_pixels: int, field: str) -> None:
    """Check a WebP's canvas: Pillow allocates it on opening."""
    if data[:4] != b"RIFF" or data[8:12] != b"WEBP" or len(data) < 30:
        return
    kind = data[12:16]
    if kind == b"VP8X":
        width = 1 + int.from_bytes(data[24:27], "little")
        height = 1 + int.from_bytes(data[27:30], "little")
    elif kind == b"VP8L":
        bits = struct.unpack_from("<I", data, 21)[0]
        width, height = 1 + (bits & 0x3FFF), 1 + (bits >> 14 & 0x3FFF)
    else:
        width, height = (side & 0x3FFF for side in struct.unpack_from("<HH", data, 26))
    _check_size(width, height, max_pixels, field)
