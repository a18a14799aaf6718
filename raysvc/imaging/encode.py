"""Pictures to files in memory: PNG (8 and 16 bits), JPEG, WebP, and Radiance .hdr.

The same array gives the same bytes: no format gets a date, a host name or the name of the software.
"""

import io
import tempfile
from pathlib import Path

import numpy as np
import OpenImageIO
from PIL import Image

from raysvc.errors import RaysvcError
from raysvc.imaging.tone_map import Words
from raysvc.types import Bytes, Floats

JPEG_QUALITY = 92
WEBP_QUALITY = 90


def encode_png(picture: Bytes) -> bytes:
    """PNG of (H, W, 3|4) uint8 sRGB; alpha is straight."""
    out = io.BytesIO()
    Image.fromarray(picture).save(out, "PNG")
    return out.getvalue()


def encode_png16(picture: Words) -> bytes:
    """PNG with 16 bits per channel of (H, W, 3|4) uint16 sRGB, which Pillow has not; alpha is
    straight."""
    height, width, channels = picture.shape
    spec = OpenImageIO.ImageSpec(width, height, channels, OpenImageIO.UINT16)
    spec.attribute("oiio:ColorSpace", "sRGB")
    spec.attribute("oiio:UnassociatedAlpha", 1)
    return _written(picture, spec, "picture.png", "a 16-bit PNG")


def encode_hdr(radiance: Floats) -> bytes:
    """Radiance .hdr of (H, W, 3) float32 linear Rec.709, not negative: 8 bits a channel with a
    common exponent."""
    height, width, _ = radiance.shape
    spec = OpenImageIO.ImageSpec(width, height, 3, OpenImageIO.FLOAT)
    return _written(radiance, spec, "picture.hdr", "a Radiance .hdr")


def _written(picture: Words | Floats, spec: OpenImageIO.ImageSpec, name: str, what: str) -> bytes:
    """Return what OpenImageIO writes, whose Python binding writes to files only."""
    with tempfile.TemporaryDirectory(prefix="raysvc-picture-") as folder:
        path = Path(folder, name)
        writer = OpenImageIO.ImageOutput.create(str(path))
        if writer is None or not writer.open(str(path), spec):
            raise RaysvcError(f"cannot write {what}: {OpenImageIO.geterror()}")
        written = writer.write_image(np.ascontiguousarray(picture))
        if not (writer.close() and written):
            raise RaysvcError(f"cannot write {what}: {writer.geterror()}")
        return path.read_bytes()


def encode_jpeg(picture: Bytes, quality: int = JPEG_QUALITY) -> bytes:
    """JPEG of (H, W, 3|4) uint8 sRGB, chroma not subsampled; what is transparent is black."""
    out = io.BytesIO()
    Image.fromarray(over_black(picture)).save(out, "JPEG", quality=quality, subsampling=0)
    return out.getvalue()


def encode_webp(picture: Bytes, quality: int = WEBP_QUALITY) -> bytes:
    """WebP, lossy, of (H, W, 3|4) uint8 sRGB; alpha is straight and kept exactly."""
    out = io.BytesIO()
    Image.fromarray(picture).save(out, "WEBP", quality=quality)
    return out.getvalue()


def over_black(picture: Bytes) -> Bytes:
    """(H, W, 3) of (H, W, 3|4) uint8 with straight alpha; what is transparent is black."""
    if picture.shape[2] == 3:
        return picture
    weighted = picture[..., :3].astype(np.uint16) * picture[..., 3:] + 127
    return (weighted // 255).astype(np.uint8)
