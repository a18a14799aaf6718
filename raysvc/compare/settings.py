"""What a caller may ask of a comparison."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Final, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Field

from raysvc.accel.registry import STRUCTURES, choose
from raysvc.compare.ray_sets import RayKind
from raysvc.errors import InvalidSetting, LimitExceeded, Unavailable
from raysvc.frame.settings import checked
from raysvc.frame.view import View
from raysvc.limits import Limits

Trees: TypeAlias = Literal["one", "per_material"]
MOST_STRUCTURES: Final = 16
ONLY_WHEN_NAMED: Final = frozenset({"brute"})
"""Structures that nobody wants on a scene of some size."""


class ComparisonSettings(BaseModel):
    """What to measure. Every field can be left out."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    rays: RayKind = Field("random", description="The kind of rays.")
    count: int = Field(100_000, ge=1, description="How many rays, exactly.")
    seed: int = Field(0, ge=0, lt=2**32, description="Seeds what is random about the rays.")
    structures: tuple[Annotated[str, Field(max_length=200)], ...] = Field(
        (),
        max_length=MOST_STRUCTURES,
        description="Names of the registry, parameters behind colons as in `bvh:max_leaf=4`; "
        "all but `brute` by default.",
    )
    trees: Trees | Literal["both"] = Field(
        "one", description="One tree over everything, one per material, or both beside each other."
    )
    camera: View = Field(
        default_factory=View, description="Whose rays, and whose heat maps; as for a render."
    )
    rounds: int = Field(5, ge=1, le=100, description="Timed rounds; the median of them counts.")
    builds: int = Field(3, ge=1, le=100, description="Timed builds; the median of them counts.")
    scaling: bool = Field(
        False, description="Also measure with parts of the triangles and with fewer threads."
    )
    heat_map: bool = Field(
        False, description="Also count node steps and triangle tests in every pixel of the camera."
    )
    threads: int | None = Field(
        None, ge=1, le=256, description="What `all_threads` means; all processors by default."
    )
    deadline_s: float | None = Field(
        None, gt=0, le=86400, description="Give up after so many seconds."
    )


def comparison_settings(values: Mapping[str, Any]) -> ComparisonSettings:
    """Return checked settings. Raises InvalidSetting naming the first field that is wrong."""
    camera = values.get("camera")
    if isinstance(camera, Mapping):
        values = {**values, "camera": checked(View, camera, "camera")}
    return checked(ComparisonSettings, values, "")


@dataclass(frozen=True, slots=True)
class Candidate:
    """A structure with parameters, as it takes part in a comparison."""

    label: str
    """As the caller wrote it."""
    name: str
    parameters: Mapping[str, Any]


def candidates(settings: ComparisonSettings) -> tuple[Candidate, ...]:
    """Return the structures that are compared, checked.

    Raises InvalidSetting for unknown names, parameters and repetitions, and Unavailable.
    """
    labels = settings.structures or tuple(
        name
        for name, entry in STRUCTURES.items()
        if name not in ONLY_WHEN_NAMED and entry.why_not() is None
    )
    if len(set(labels)) < len(labels):
        raise InvalidSetting("names a structure twice", field="structures")
    return tuple(_candidate(label) for label in labels)


def check_size(settings: ComparisonSettings, triangles: int, limits: Limits) -> None:
    """Refuse what would take too long. Raises LimitExceeded."""
    if settings.count > limits.max_comparison_rays:
        raise LimitExceeded(f"must be at most {limits.max_comparison_rays:,} rays", field="count")
    pixels = settings.camera.width * settings.camera.height
    if settings.heat_map and pixels > limits.max_comparison_rays:
        raise LimitExceeded(
            f"a heat map takes one ray per pixel, and at most {limits.max_comparison_rays:,}",
            field="camera.width",
        )
    tests = triangles * max(settings.count, pixels if settings.heat_map else 0)
    if tests > limits.max_brute_tests and any(c.name == "brute" for c in candidates(settings)):
        raise LimitExceeded(
            f"brute tests every triangle with every ray, here {tests:,} pairs, "
            f"and at most {limits.max_brute_tests:,} are allowed",
            field="structures",
        )


def _candidate(label: str) -> Candidate:
    name, *assignments = label.split(":")
    try:
        name = choose(name)
    except (InvalidSetting, Unavailable) as error:
        raise type(error)(error.message, field="structures") from None
    parameters: dict[str, Any] = {}
    for assignment in assignments:
        key, equals, text = assignment.partition("=")
        if not equals:
            raise InvalidSetting(f"write NAME:KEY=VALUE, not {label!r}", field="structures")
        try:
            parameters[key] = json.loads(text)
        except (ValueError, RecursionError):
            parameters[key] = text
    checked(STRUCTURES[name].params, parameters, f"structures.{name}")
    return Candidate(label, name, parameters)
