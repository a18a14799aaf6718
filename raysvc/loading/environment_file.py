"""Environment maps: Radiance .hdr through OpenImageIO, .exr through OpenEXR."""

import os
import re
from collections.abc import Mapping

import numpy as np
import OpenImageIO

from raysvc.builtin import BUILTIN_ENVIRONMENTS
from raysvc.errors import InvalidEnvironment, LimitExceeded, NotFound, RaysvcError, Unsupported
from raysvc.limits import DEFAULT_LIMITS, Limits
from raysvc.loading.exr_file import read_exr
from raysvc.loading.files import Files
from raysvc.loading.named_file import named_file
from raysvc.scene import Environment
from raysvc.types import Floats

BUILTIN_PREFIX = "builtin:"
MAX_RADIANCE = 1e9
"""Brighter is no measurement: the sun has about 1e5 where a white wall has 1. Sums stay finite."""
_EXR_MAGIC = b"\x76\x2f\x31\x01"
_HDR_MAGICS = (b"#?RADIANCE", b"#?RGBE")

_HEADER_BYTES = 2048

_RESOLUTION = re.compile(rb"\n([-+][XY]) \d+ ([-+][XY]) \d+\n")
_BACKWARDS = (b"+Y", b"-X")
"""Axes along which the first pixel belongs last: rows go down (-Y), columns to the right (+X)."""

Source = str | os.PathLike[str] | Files | Mapping[str, bytes]


def load_environment(source: Source, limits: Limits = DEFAULT_LIMITS) -> Environment:
    """Load a lat-long map of radiance.

    The centre column of a file is what is seen along -Z, with +X to its right. An OpenEXR file with
    the attribute `envmap` follows that format's own definition instead.

    Parameters
    ----------
    source
        `builtin:NAME`, the path of an .hdr or .exr file, or one such file in memory: Files, or
        a mapping of its name to its bytes
    limits
        what is refused for its size

    Raises
    ------
    NotFound
        no built-in environment has that name
    InvalidEnvironment, Unsupported, LimitExceeded
        the file is broken, is something else, or is too large; nothing else is raised
    """
    if isinstance(source, str) and source.startswith(BUILTIN_PREFIX):
        name = source.removeprefix(BUILTIN_PREFIX)
        if name not in BUILTIN_ENVIRONMENTS:
            known = ", ".join(BUILTIN_ENVIRONMENTS)
            raise NotFound(f"no built-in environment {name!r}; there are {known}")
        return BUILTIN_ENVIRONMENTS[name]()
    name, data = _named_bytes(source, limits)
    try:
        if data.startswith(_EXR_MAGIC):
            return _checked(*read_exr(data, limits, name), name)
        if data.startswith(_HDR_MAGICS):
            return _checked(_read_hdr(data, limits, name), [], name)
    except RaysvcError:
        raise
    except MemoryError:
        raise LimitExceeded("does not fit into memory", name) from None
    raise InvalidEnvironment("is neither Radiance .hdr nor OpenEXR", name)


def _named_bytes(source: Source, limits: Limits) -> tuple[str, bytes]:
    try:
        if isinstance(source, Mapping):
            if len(source) != 1:
                raise InvalidEnvironment(f"needs one file, has {len(source)}", "environment")
            source = Files.from_memory(source, next(iter(source)), limits)
        elif not isinstance(source, Files):
            source = Files.from_path(source, limits)
        return source.main, source.read(source.main, source.main)
    except LimitExceeded:
        raise
    except RaysvcError as error:
        raise InvalidEnvironment(error.message, error.field) from None


def _read_hdr(data: bytes, limits: Limits, name: str) -> Floats:
    """(H, W, 3) float32 of a Radiance file, turned upright if its scanlines are not top-down."""
    if b"32-bit_rle_xyze" in data[:_HEADER_BYTES]:
        raise Unsupported("is in XYZ (32-bit_rle_xyze); environments need RGB", name)
    # OpenImageIO's Python binding reads from files only.
    with named_file(data, ".hdr") as path:
        picture = OpenImageIO.ImageInput.open(path)
        if picture is None:
            raise InvalidEnvironment(_reason(OpenImageIO.geterror(), path), name)
        try:
            spec = picture.spec()
            if spec.width * spec.height > limits.max_environment_pixels:
                size = f"{spec.width} x {spec.height} pixels"
                limit = f"{limits.max_environment_pixels:,}"
                raise LimitExceeded(f"{size}; the limit is {limit}", name)
            pixels = picture.read_image(OpenImageIO.FLOAT)
            if pixels is None or spec.nchannels != 3:
                raise InvalidEnvironment(_reason(picture.geterror(), path), name)
            return _upright(np.asarray(pixels, np.float32), data)
        finally:
            picture.close()


def _upright(pixels: Floats, data: bytes) -> Floats:
    """Undo the order of scanlines that the header gives; OpenImageIO leaves that to its callers."""
    resolution = _RESOLUTION.search(data[:_HEADER_BYTES])
    if resolution is None:
        return pixels
    for axis in (0, 1):
        if resolution[axis + 1] in _BACKWARDS:
            pixels = np.flip(pixels, axis)
    return pixels.transpose(1, 0, 2) if resolution[1].endswith(b"X") else pixels


def _reason(message: str, path: str) -> str:
    """What OpenImageIO says, without the temporary file's name."""
    said = message.replace(path, "the file").strip()[:200]
    return f"cannot be read as Radiance .hdr ({said or 'damaged'})"


def _checked(radiance: Floats, warnings: list[str], name: str) -> Environment:
    """Make pixels finite, not negative and of this world, and say what was changed."""
    pixels = np.array(radiance, np.float32, order="C")
    for faulty, value, what in (
        (np.isnan(pixels), 0.0, "were not numbers and are now black"),
        (pixels < 0.0, 0.0, "were negative and are now black"),
        (pixels > MAX_RADIANCE, MAX_RADIANCE, f"were above {MAX_RADIANCE:g} and are now that"),
    ):
        if faulty.any():
            pixels[faulty] = value
            warnings.append(f"{int(faulty.sum()):,} values {what}")
    height, width = pixels.shape[:2]
    if width != 2 * height:
        warnings.append(f"{width} x {height} is not 2:1 as a lat-long map should be; stretched")
    return Environment(pixels, name=os.path.splitext(name)[0], warnings=tuple(warnings))
