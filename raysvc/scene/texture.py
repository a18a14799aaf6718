"""A picture that a material reads."""

from dataclasses import dataclass
from typing import Literal

from raysvc.types import Bytes

Wrap = Literal["repeat", "clamp", "mirror"]


@dataclass(frozen=True, slots=True, eq=False)
class Texture:
    """8-bit texels with their sampler (glTF 2.0, section 3.8.4).

    Attributes
    ----------
    texels
        (H, W, 4) uint8 RGBA, row 0 at v = 0, which is the top as glTF has it. Whether the
        colour is sRGB is a matter of the slot that reads it, not of the texture.
    wrap_u, wrap_v
        what lies outside 0..1
    nearest
        magnified without interpolation (glTF magFilter NEAREST)
    """

    texels: Bytes
    wrap_u: Wrap = "repeat"
    wrap_v: Wrap = "repeat"
    nearest: bool = False
    name: str = ""
