"""The layers of a frame to one file in memory: OpenEXR with named channels, and NumPy's NPZ.

OpenEXR channels: beauty is R, G, B, A, so that every viewer opens it; others are `layer.channel`:

    depth      depth.Z                     float32 metres along the view axis, inf where nothing is
    normal     normal.X normal.Y normal.Z; and so bent_normal
    id         id.I                        uint32, 4294967295 where nothing is (-1 in the array)
    others     NAME.V (one channel), NAME.U .V (two), NAME.R .G .B (three), NAME.R .G .B .A (four)

Whole numbers are always uint32, depth is always float32; the rest is float32 or, if asked, half.
"""

import io
from collections.abc import Mapping
from typing import Any

import numpy as np
import OpenEXR
from numpy.typing import NDArray

from raysvc.errors import InvalidInput

SUFFIXES: Mapping[str, tuple[str, ...]] = {
    "depth": ("Z",),
    "normal": ("X", "Y", "Z"),
    "bent_normal": ("X", "Y", "Z"),
    "id": ("I",),
}
SUFFIXES_BY_CHANNELS: Mapping[int, tuple[str, ...]] = {
    1: ("V",),
    2: ("U", "V"),
    3: ("R", "G", "B"),
    4: ("R", "G", "B", "A"),
}
LARGEST_HALF = np.float32(65504.0)


def encode_exr(layers: Mapping[str, NDArray[Any]], half: bool = False) -> bytes:
    """OpenEXR, ZIP-compressed scan lines, of layers (H, W) or (H, W, C), float32 or int32.

    Parameters
    ----------
    layers
        by name; all of one size; `beauty` is (H, W, 4) premultiplied linear
    half
        16-bit floats for everything but depth; finite values beyond 65504 become 65504

    Raises InvalidInput for a layer whose shape has no channel names, or whose size differs.
    """
    channels: dict[str, NDArray[Any]] = {}
    for layer, array in layers.items():
        planes = array.reshape(*array.shape[:2], -1)
        for i, channel in enumerate(channel_names(layer, array)):
            channels[channel] = _stored(planes[..., i], half and layer != "depth")
    if len({plane.shape for plane in channels.values()}) != 1:
        raise InvalidInput("layers must be there and be all of one size", field="layers")
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    out = io.BytesIO()
    OpenEXR.File(header, channels).write(out)
    return out.getvalue()


def channel_names(layer: str, array: NDArray[Any]) -> tuple[str, ...]:
    """OpenEXR's channels for a layer, in the order of the array's last axis."""
    count = array.shape[2] if array.ndim == 3 else 1
    suffixes = SUFFIXES.get(layer) or SUFFIXES_BY_CHANNELS.get(count, ())
    if array.ndim not in (2, 3) or len(suffixes) != count:
        raise InvalidInput(f"no channels for an array of shape {array.shape}", field=layer)
    return suffixes if layer == "beauty" else tuple(f"{layer}.{suffix}" for suffix in suffixes)


def encode_npz(layers: Mapping[str, NDArray[Any]]) -> bytes:
    """NumPy's NPZ of layers, uncompressed: it holds them as they are, and opens at once."""
    out = io.BytesIO()
    np.savez(out, allow_pickle=False, **layers)
    return out.getvalue()


def _stored(plane: NDArray[Any], half: bool) -> NDArray[Any]:
    if plane.dtype.kind in "iu":
        return np.ascontiguousarray(plane).astype(np.uint32)
    if half:
        finite = np.clip(plane, -LARGEST_HALF, LARGEST_HALF)
        return np.where(np.isinf(plane), plane, finite).astype(np.float16)
    return np.ascontiguousarray(plane, np.float32)
