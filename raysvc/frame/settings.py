"""What a caller may ask of a frame, with the defaults. Unknown keys and values that are not listed
are errors."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from raysvc.errors import InvalidSetting, LimitExceeded
from raysvc.lens.aperture import MAX_BLADES, Aperture
from raysvc.lens.bokeh import Bokeh
from raysvc.limits import Limits
from raysvc.scene import Camera

Model = TypeVar("Model", bound=BaseModel)

Colour = tuple[
    Annotated[float, Field(ge=0, le=1e6)],
    Annotated[float, Field(ge=0, le=1e6)],
    Annotated[float, Field(ge=0, le=1e6)],
]


class Settings(BaseModel):
    """How to render. Every field can be left out."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    mode: Literal["hybrid", "reference"] = Field(
        "hybrid",
        description="`hybrid`: rasterise what is seen, trace reflections, shadows and occlusion. "
        "`reference`: follow random paths of light, as the truth to measure by.",
    )
    samples: int = Field(
        64, ge=1, le=65536, description="Paths per pixel in reference mode; hybrid takes none."
    )
    structure: Literal["auto", "embree", "bvh", "bvh_stackless", "kd", "bih", "brute"] = Field(
        "auto",
        description="What answers rays, by its name in the registry; `auto` is the fastest known.",
    )
    trees: Literal["one", "per_material"] = Field(
        "one", description="One structure over everything, or one per material: the same picture."
    )
    passes: Literal["single", "multi"] = Field(
        "single",
        description="Shade what reflected rays meet at once, or material by material (and, with one"
        " tree per material, tree by tree): the same picture.",
    )
    bounces: int | None = Field(
        None,
        ge=0,
        le=8,
        description="How many times a reflection, or in reference mode a path, is followed on from "
        "what it has met; 3 by default, and 8 in reference mode.",
    )
    texture_filter: Literal["ewa", "mip", "sat", "bilinear", "nearest"] = Field(
        "ewa",
        description="How textures are read: over the ellipse that a pixel covers (`ewa`), between "
        "two prefiltered sizes (`mip`), over rectangles (`sat`), or at a point.",
    )
    shadows: bool = Field(
        True, description="Trace shadows of the sun, of lamps and punctual lights."
    )
    occlusion_samples: int = Field(
        16,
        ge=0,
        le=256,
        description="Rays per pixel that say how much of the sky is hidden, and what light "
        "comes from there instead; 0 leaves both out.",
    )
    occlusion_radius: float | None = Field(
        None,
        gt=0,
        description="How far occlusion reaches, in metres; the scene's diagonal by default.",
    )
    ibl: Literal["sat", "sh9", "split_sum", "brute"] = Field(
        "sat",
        description="How the environment is filtered: narrow lobes by summed-area tables, wide ones"
        " by levels (`sat`); `sh9` takes diffuse light from nine spherical harmonics; `split_sum` "
        "takes one prefiltered lookup per specular lobe; `brute` sums a thousand points of the map "
        "for each lobe, slowly.",
    )
    ibl_order: Literal[2, 1, 3] = Field(
        2,
        description="How often the tables are integrated: boxes (1), tents, quadratic filters (3).",
    )
    sat_builder: Literal["fused", "doubling", "scan", "strips"] = Field(
        "fused", description="How the tables are summed; all give the same, but for rounding."
    )
    ibl_lobe_samples: Literal[4, 1, 2] = Field(
        4,
        description="Filtered samples per specular lobe of the environment; one where it is faint.",
    )
    multiple_scattering: bool = Field(
        False,
        description="Give rough metal back the light that its microfacets scatter more than once, "
        "which glTF's formula loses.",
    )
    lens: Literal["spread", "gather", "accumulate", "none"] = Field(
        "spread",
        description="How a camera with an aperture gets its depth of field: by spreading what is "
        "out of focus (`spread`), by averaging about each pixel (`gather`: fast, and wrong at "
        "silhouettes), as the mean of `lens_samples` pictures from all over the lens "
        "(`accumulate`: right, and slow), or not at all.",
    )
    lens_samples: int = Field(
        64, ge=1, le=65536, description="Pictures that `lens=accumulate` takes the mean of."
    )
    lens_shape: Literal["aperture", "box"] = Field(
        "aperture",
        description="What a point out of focus becomes: the shape of the `aperture`, or a `box` as "
        "wide on the whole.",
    )
    lens_order: int = Field(
        1,
        ge=1,
        le=3,
        description="Order of the spreading filter: 1 is even, 2 and 3 are boxes folded with "
        "themselves, ever smoother.",
    )
    lens_layers: int | None = Field(
        None,
        ge=1,
        le=16,
        description="Slices of what is out of focus, which hide each other; by default as many as "
        "there are octaves of blur.",
    )
    aperture_blades: int = Field(
        0, ge=0, le=MAX_BLADES, description="Corners of the lens's opening; 0 is a disc."
    )
    aperture_rotation_deg: float = Field(
        0.0,
        ge=-360,
        le=360,
        description="Turns the opening counter-clockwise; without, one corner is up.",
    )
    aa: Literal["edges", "directional", "full", "accumulate", "none"] = Field(
        "edges",
        description="Extra samples on `edges` only, or on the `full` picture; `directional` "
        "smooths edges along themselves and shades none; `accumulate` takes the mean of whole "
        "pictures, each with its own shadows and reflections; or `none`.",
    )
    aa_samples: int = Field(
        8, ge=1, le=64, description="Samples per pixel where anti-aliasing applies."
    )
    environment_yaw_deg: float = Field(
        0.0,
        ge=-36000,
        le=36000,
        description="Turns the environment counter-clockwise seen from above.",
    )
    environment_strength: float = Field(
        1.0, ge=0, le=1e6, description="Multiplies the environment's light."
    )
    background: Literal["environment", "transparent"] | Colour = Field(
        "environment",
        description="What is behind the scene: the environment, nothing (alpha 0), or linear RGB.",
    )
    exposure_stops: float = Field(
        0.0, ge=-32, le=32, description="Powers of two that multiply the picture."
    )
    tone_map: Literal["pbr_neutral", "agx", "aces", "reinhard", "linear"] = Field(
        "pbr_neutral", description="How scene light becomes display light."
    )
    seed: int = Field(0, ge=0, lt=2**32, description="Seeds everything that is random.")
    threads: int | None = Field(
        None, ge=1, le=256, description="Worker threads; all processors by default."
    )
    deadline_s: float | None = Field(
        None, gt=0, le=86400, description="Give up after so many seconds."
    )

    @field_validator("aperture_blades")
    @classmethod
    def _makes_a_polygon(cls, blades: int) -> int:
        if blades in (1, 2):
            raise ValueError("must be 0 for a disc, or 3 and more")
        return blades

    @property
    def bokeh(self) -> Bokeh:
        """What the lens makes of a point."""
        boxed = self.lens_shape == "box" or self.lens_order > 1
        return Bokeh("box" if boxed else "aperture", self.lens_order, self.aperture)

    @property
    def aperture(self) -> Aperture:
        """The lens's opening."""
        return Aperture(self.aperture_blades, self.aperture_rotation_deg)

    @property
    def bounce_limit(self) -> int:
        """`bounces`, or the mode's default."""
        if self.bounces is not None:
            return self.bounces
        return 3 if self.mode == "hybrid" else 8

    @property
    def shades_samples(self) -> bool:
        """Are samples beside pixel centres shaded, where there are edges or everywhere?"""
        return self.aa in ("edges", "full") and self.aa_samples > 1


def settings_from(values: Mapping[str, Any] | Settings | None) -> Settings:
    """Return checked settings. Raises InvalidSetting naming the first field that is wrong, and its
    limit."""
    if isinstance(values, Settings):
        return values
    return checked(Settings, {} if values is None else values, "settings")


def check_cost(settings: Settings, camera: Camera, limits: Limits) -> None:
    """Raise LimitExceeded if a picture would take more samples than the limits allow."""
    pixels = camera.width * camera.height
    if settings.mode == "reference" and pixels * settings.samples > limits.max_paths:
        raise LimitExceeded(
            f"width x height x samples must be at most {limits.max_paths:,} paths",
            field="settings.samples",
        )
    if accumulates(settings, camera) and pixels * settings.lens_samples > limits.max_paths:
        raise LimitExceeded(
            f"width x height x lens_samples must be at most {limits.max_paths:,}",
            field="settings.lens_samples",
        )


def accumulates(settings: Settings, camera: Camera) -> bool:
    """Is a frame the mean of several through the lens?"""
    through_lens = settings.lens == "accumulate" and camera.aperture_radius > 0.0
    return through_lens and settings.mode == "hybrid"


def checked(model: type[Model], values: object, where: str) -> Model:
    """Validate a mapping against a model; its first fault becomes an InvalidSetting that names the
    field."""
    if not isinstance(values, Mapping):
        raise InvalidSetting(f"must be a mapping, not {type(values).__name__}", field=where)
    try:
        return model.model_validate(dict(values))
    except ValidationError as error:
        raise invalid_setting(error, where) from None


def invalid_setting(error: ValidationError, where: str) -> InvalidSetting:
    """Say what pydantic found, in one sentence with the field's name."""
    fault = error.errors(include_url=False)[0]
    path = [str(part) for part in fault["loc"]]
    name = ".".join(part for part in (where, *path[:1]) if part)
    if fault["type"] == "extra_forbidden":
        return InvalidSetting("unknown key", field=name)
    given = repr(fault.get("input"))
    return InvalidSetting(f"{fault['msg']} (got {given[:80]})", field=name)
