"""The closed list of structures: names, builders, parameters, and whether they run here."""

import importlib.util
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Final

from pydantic import BaseModel, ValidationError

from raysvc.accel.base import Accelerator, Builder, Triangles
from raysvc.accel.bih import Bih, BihParams
from raysvc.accel.brute import Brute, BruteParams
from raysvc.accel.bvh import Bvh, BvhParams
from raysvc.accel.bvh_stackless import BvhStackless, BvhStacklessParams
from raysvc.accel.embree import Embree, EmbreeParams
from raysvc.accel.kd import Kd, KdParams
from raysvc.errors import InvalidSetting, Unavailable


@dataclass(frozen=True, slots=True)
class Entry:
    """One structure of the registry."""

    build: Builder
    params: type[BaseModel]
    summary: str
    requires: str | None = None
    """Name of a module that must be installed."""

    def why_not(self) -> str | None:
        """Why this machine cannot run it, or None if it can."""
        if self.requires is not None and importlib.util.find_spec(self.requires) is None:
            return (
                f"the package {self.requires} is not installed (it has no wheel for every platform)"
            )
        return None


STRUCTURES: Final[Mapping[str, Entry]] = MappingProxyType(
    {
        "embree": Entry(Embree, EmbreeParams, "Intel Embree through embreex", requires="embreex"),
        "bvh": Entry(Bvh, BvhParams, "two-wide hierarchy of boxes by binned SAH"),
        "bvh_stackless": Entry(
            BvhStackless, BvhStacklessParams, "the same hierarchy, traversed by links, no stack"
        ),
        "kd": Entry(Kd, KdParams, "kd-tree by SAH, references clipped to their cells"),
        "bih": Entry(Bih, BihParams, "bounding interval hierarchy, two planes a node"),
        "brute": Entry(Brute, BruteParams, "tests every triangle; the oracle, for small scenes"),
    }
)

FASTEST_FIRST: Final = ("embree", "bvh", "bvh_stackless", "kd", "bih", "brute")
"""The order in which `auto` chooses, by the benchmark."""


def choose(name: str) -> str:
    """Return the structure that `name` stands for: itself, or for `auto` the fastest to be had.

    Raises InvalidSetting for an unknown name and Unavailable for one that this machine cannot run.
    """
    if name == "auto":
        return next(known for known in FASTEST_FIRST if STRUCTURES[known].why_not() is None)
    entry = STRUCTURES.get(name)
    if entry is None:
        raise InvalidSetting(
            f"unknown structure {name!r}; known are {', '.join(STRUCTURES)}", field="structure"
        )
    reason = entry.why_not()
    if reason is not None:
        raise Unavailable(reason, field="structure")
    return name


def build(
    name: str, triangles: Triangles, parameters: Mapping[str, Any] | None = None
) -> Accelerator:
    """Build a structure over triangles; unknown or impossible parameters are InvalidSetting."""
    entry = STRUCTURES[choose(name)]
    try:
        params = entry.params.model_validate(dict(parameters or {}))
    except ValidationError as error:
        fault = error.errors(include_url=False)[0]
        where = ".".join(str(part) for part in fault["loc"])
        raise InvalidSetting(str(fault["msg"]), field=f"structure.{name}.{where}") from None
    return entry.build(triangles, params)
