"""What is asked of an environment's filtered maps."""

from typing import Annotated, Final, Literal

from pydantic import BaseModel, ConfigDict, Field

from raysvc.errors import InvalidSetting
from raysvc.lighting.filtered_map import MAX_HEIGHT, MAX_WIDTH

MEDIA_TYPES: Final = {
    "exr": "image/x-exr",
    "hdr": "image/vnd.radiance",
    "npz": "application/x-npz",
    "png": "image/png",
    "json": "application/json",
}
"""By the name of a format; where a client likes several equally, the first of them wins."""


class FilteredBody(BaseModel):
    """Asks for an environment's filtered maps, its irradiance or its spherical harmonics."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, title="FilteredBody")

    roughness: list[Annotated[float, Field(ge=0, le=1)]] = Field(
        default_factory=list,
        max_length=16,
        description="glTF's, a map for each: 0 is the map itself, 1 irradiance / pi.",
    )
    irradiance: bool = Field(
        False, description="Also the irradiance of a surface that faces each direction."
    )
    width: int = Field(512, ge=1, le=MAX_WIDTH, description="Texels across.")
    height: int | None = Field(
        None, ge=1, le=MAX_HEIGHT, description="Texels down, at most the width; half of it."
    )
    environment_yaw_deg: float = Field(
        0.0, ge=-36000, le=36000, description="Turns it counter-clockwise seen from above."
    )
    environment_strength: float = Field(1.0, ge=0, le=1e6, description="Multiplies its light.")
    format: Literal["exr", "hdr", "npz", "png", "json"] | None = Field(
        None, description="By default what `Accept` asks for, else `exr`."
    )

    @property
    def size(self) -> tuple[int, int]:
        """Width and height."""
        return self.width, self.height or max(self.width // 2, 1)


def check_harmonics_only(body: FilteredBody) -> None:
    """Raise InvalidSetting for what says something of maps: harmonics have no use for it."""
    for field in ("roughness", "irradiance", "width", "height"):
        if field in body.model_fields_set and getattr(body, field):
            raise InvalidSetting("is of maps; as JSON there are harmonics only", field=field)


class Sh9Body(BaseModel):
    """Nine spherical harmonics of an environment."""

    convention: str
    basis: list[str] = Field(description="Y_lm of each coefficient.")
    radiance: list[list[float]] = Field(description="Linear RGB.")
    irradiance: list[list[float]] = Field(description="Linear RGB, not divided by pi.")
