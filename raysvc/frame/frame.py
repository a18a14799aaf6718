"""A finished frame: layers, numbers, and files made from them."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from numpy.typing import NDArray

from raysvc.errors import InvalidSetting
from raysvc.frame.settings import Settings
from raysvc.frame.statistics import Statistics
from raysvc.imaging.encode import encode_jpeg, encode_png, encode_png16, encode_webp
from raysvc.imaging.encode_layers import encode_exr, encode_npz
from raysvc.imaging.layer_picture import layer_picture
from raysvc.imaging.tone_map import display8, display16
from raysvc.types import Bytes

FORMATS: Final = ("png", "png16", "jpg", "webp", "exr", "npz")
"""What a frame can be encoded as."""


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """One picture and what is known about its pixels.

    Layers, by name, of H x W pixels with row 0 at the top:

    - `beauty` (H, W, 4) float32: linear scene-referred Rec.709, premultiplied by alpha, after
      the lens
    - `depth` (H, W) float32: metres along the view axis, inf where there is nothing
    - `normal` (H, W, 3) float32: world-space shading normal, 0 where there is nothing
    - `albedo` (H, W, 3) float32: linear base colour
    - `id` (H, W) int32: triangle, -1 where there is nothing
    - `object`, `material` (H, W) int32: the instance and material of that triangle
    - `occlusion` (H, W) float32: the part of the hemisphere that is free, 1 where there is nothing;
      not in reference mode
    - `bent_normal` (H, W, 3) float32: mean free direction, 0 where there is nothing; not in
      reference mode
    - `edge` (H, W) float32: 1 where anti-aliasing took more samples; not in reference mode
    - `coc` (H, W) float32: signed diameter of the circle of confusion in pixels, less than 0
      in front of what is sharp; only when there was a lens
    """

    layers: Mapping[str, NDArray[Any]]
    statistics: Statistics
    settings: Settings

    def display(self) -> Bytes:
        """Return the picture for a screen: (H, W, 4) uint8, tone mapped, sRGB, straight alpha."""
        beauty = self.layers["beauty"]
        return display8(beauty, self.settings.tone_map, self.settings.exposure_stops)

    def encode(self, format: str, layer: str | None = None) -> bytes:
        """Return a file of the given format: the tone-mapped picture, or all layers for exr and
        npz.

        With `layer`, that layer alone: as it is in exr and npz, made visible in the others.
        Raises InvalidSetting for a format or layer that there is not.
        """
        return encode_layers(self.layers, self.settings, format, layer)

    def save(self, path: str | Path) -> None:
        """Write a file in the format that its suffix names; .jpeg is .jpg.

        Raises InvalidSetting for an unknown suffix.
        """
        save_layers(self.layers, self.settings, Path(path))


def encode_layers(
    layers: Mapping[str, NDArray[Any]], settings: Settings, format: str, layer: str | None = None
) -> bytes:
    """Encode layers, `beauty` among them, as `Frame.encode` says."""
    if format not in FORMATS:
        raise InvalidSetting(f"{format!r} is not one of {', '.join(FORMATS)}", field="format")
    if layer is not None and layer not in layers:
        raise InvalidSetting(f"no layer {layer!r}; there are {', '.join(layers)}", field="layer")
    if format in ("exr", "npz"):
        chosen = layers if layer is None else {layer: layers[layer]}
        return encode_exr(chosen) if format == "exr" else encode_npz(chosen)
    beauty, shown_as = layers["beauty"], (settings.tone_map, settings.exposure_stops)
    if format == "png16":
        if layer not in (None, "beauty"):
            raise InvalidSetting("only the picture has 16 bits; use exr", field="format")
        return encode_png16(display16(beauty, *shown_as))
    if layer in (None, "beauty"):
        shown = display8(beauty, *shown_as)
        # Alpha that says nothing is left out.
        shown = shown if (shown[..., 3] < 255).any() else shown[..., :3]
    else:
        assert layer is not None
        shown = layer_picture(layer, layers[layer])
    encoders = {"png": encode_png, "jpg": encode_jpeg, "webp": encode_webp}
    return encoders[format](shown)


def save_layers(layers: Mapping[str, NDArray[Any]], settings: Settings, path: Path) -> None:
    """Write layers to a file, as `Frame.save` says."""
    path.write_bytes(encode_layers(layers, settings, format_of(path)))


def format_of(path: Path) -> str:
    """The format that a file's suffix names; .jpeg is jpg."""
    suffix = path.suffix.lower().lstrip(".")
    return "jpg" if suffix == "jpeg" else suffix
