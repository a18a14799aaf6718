"""An environment filtered for several roughnesses at once, and files of that.

Maps are named `roughness_0_25` (no full stop: OpenEXR parts layers and channels by it) and
`irradiance`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from raysvc.errors import InvalidSetting, LimitExceeded
from raysvc.imaging.encode import encode_hdr, encode_png
from raysvc.imaging.encode_layers import encode_exr, encode_npz
from raysvc.imaging.tone_map import display8
from raysvc.lighting.filtered_map import check_size, filtered_map, irradiance_map
from raysvc.limits import DEFAULT_LIMITS, Limits
from raysvc.parallel import Control
from raysvc.scene import Environment
from raysvc.types import Floats

FORMATS: Final = ("exr", "hdr", "npz", "png")
"""What filtered maps can be encoded as."""
FORMATS_OF_SEVERAL: Final = ("exr", "npz")
"""Which of them hold more than one."""
MAX_MAPS: Final = 17
"""Sixteen roughnesses and irradiance."""
TONE_MAP: Final = "pbr_neutral"
"""Of pictures for a screen."""


@dataclass(frozen=True, slots=True, eq=False)
class FilteredMaps:
    """Lat-long maps of one size."""

    maps: Mapping[str, Floats]
    """(H, W, 3) float32 linear Rec.709, by name."""

    def encode(self, format: str) -> bytes:
        """Return a file. Raises InvalidSetting for a format that there is not, or not of several.

        A single map has the channels R, G, B in `exr`, several are layers by their names; `npz`
        holds arrays by name. `png` is tone mapped, to be looked at.
        """
        check_format(format, len(self.maps))
        if format == "npz":
            return encode_npz(self.maps)
        if format == "exr" and len(self.maps) > 1:
            return encode_exr(self.maps)
        (only,) = self.maps.values()
        if format == "exr":
            return encode_exr({"beauty": only})
        return encode_hdr(only) if format == "hdr" else encode_png(display8(only, TONE_MAP))


def check_format(format: str, count: int) -> None:
    """Raise InvalidSetting for a format that there is not, or that does not hold so many maps."""
    if format not in FORMATS:
        raise InvalidSetting(f"{format!r} is not one of {', '.join(FORMATS)}", field="format")
    if count > 1 and format not in FORMATS_OF_SEVERAL:
        several = " or ".join(FORMATS_OF_SEVERAL)
        raise InvalidSetting(f"{format} holds one map, not {count}; use {several}", field="format")


def filtered_maps(
    environment: Environment,
    roughness: Sequence[float],
    irradiance: bool,
    size: tuple[int, int],
    *,
    yaw_deg: float = 0.0,
    strength: float = 1.0,
    limits: Limits = DEFAULT_LIMITS,
    control: Control | None = None,
) -> FilteredMaps:
    """Filter for each roughness as `filtered_map` does, and for irradiance if that is asked for.

    Raises InvalidSetting and LimitExceeded naming `roughness`, `width` or `height`, before anything
    is filtered.
    """
    control = control or Control()
    width, height = size
    names = [map_name(value) for value in roughness]
    count = len(names) + irradiance
    if count == 0:
        raise InvalidSetting("needs a roughness, or irradiance", field="roughness")
    if count > MAX_MAPS:
        raise LimitExceeded(f"must be at most {MAX_MAPS} maps, are {count}", field="roughness")
    for place, name in enumerate(names):
        if name in names[:place]:
            raise InvalidSetting(f"has {roughness[place]:g} twice", field="roughness")
        if not 0.0 <= roughness[place] <= 1.0:
            raise InvalidSetting(f"must be 0 to 1, is {roughness[place]}", field="roughness")
    check_size(width, height)
    if width * height * count > limits.max_filtered_texels:
        raise LimitExceeded(
            f"width x height x maps must be at most {limits.max_filtered_texels:,}, is "
            f"{width * height * count:,}",
            field="width",
        )
    maps = {}
    for place, (name, value) in enumerate(zip(names, roughness, strict=True)):
        control.progress("filtering", place / count)
        maps[name] = filtered_map(
            environment,
            value,
            width,
            height,
            yaw_deg=yaw_deg,
            strength=strength,
            control=control.quiet(),
        )
    if irradiance:
        control.progress("filtering", len(names) / count)
        maps["irradiance"] = irradiance_map(
            environment,
            width,
            height,
            yaw_deg=yaw_deg,
            strength=strength,
            control=control.quiet(),
        )
    control.progress("filtering", 1.0)
    return FilteredMaps(maps)


def map_name(roughness: float) -> str:
    """`roughness_0_25`."""
    return f"roughness_{roughness:g}".replace(".", "_")
