"""What a caller may ask of a probe: an environment that is captured from a point of the scene."""

from collections.abc import Mapping
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from raysvc.errors import InvalidSetting
from raysvc.frame.settings import Settings, checked
from raysvc.frame.view import Vector
from raysvc.geometry.winding import windings
from raysvc.scene import Scene
from raysvc.types import Bools, Longs

FIELD = "environment"
"""What callers name it by; so do errors."""
INSIDE = 0.5
"""Of an object's winding number, from which on a point is in it."""


class Probe(BaseModel):
    """A point of the scene, from which glossy surfaces see what is around them."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    probe_at: Vector = Field(description="From where the scene is captured, in metres.")
    size: int = Field(128, ge=16, le=512, description="Pixels along a side of the captured cube.")
    without: Annotated[tuple[int | str, ...], Field(max_length=1000)] | None = Field(
        None,
        description="What the probe does not see: numbers of objects (as in the layer `object`) "
        "and names of materials; by default the objects that the point is inside of.",
    )

    def shown(self, scene: Scene) -> Bools:
        """(F,) triangles that the probe sees."""
        if self.without is None:
            return ~np.isin(scene.object_of_triangle, self._around(scene))
        shown = np.ones(len(scene.triangles), np.bool_)
        for name in self.without:
            shown &= ~_called(scene, name)
        return shown

    def _around(self, scene: Scene) -> Longs:
        """Numbers of the objects that the point is inside of."""
        if not len(scene.triangles):
            return np.zeros(0, np.int64)
        corners = scene.positions[scene.triangles].astype(np.float64)
        group = scene.object_of_triangle
        winding = windings(corners, group, int(group.max()) + 1, np.array(self.probe_at))
        return np.flatnonzero(winding > INSIDE)


def _called(scene: Scene, name: int | str) -> Bools:
    """(F,) triangles of an object by number, or of materials by name."""
    if isinstance(name, int):
        found: Bools = scene.object_of_triangle == name
        known = f"{len(np.unique(scene.object_of_triangle))} objects"
    else:
        named = [k for k, material in enumerate(scene.materials) if material.name == name]
        found = np.isin(scene.material_of_triangle, named)
        known = ", ".join(repr(m.name) for m in scene.materials[:20]) or "no materials"
    if not found.any():
        raise InvalidSetting(f"nothing is called {name!r}; there are {known}", f"{FIELD}.without")
    return found


def probe_from(values: Mapping[str, Any]) -> tuple[Any, Probe]:
    """Check what a caller gave for an environment: what it calls the one around the scene (None is
    the default one), and the probe. Raises InvalidSetting."""
    rest = {key: value for key, value in values.items() if key != "environment"}
    return values.get("environment"), checked(Probe, rest, FIELD)


def check_probe(probe: Probe, settings: Settings, scene: Scene) -> None:
    """Raise InvalidSetting for settings that no probe goes with, and for what is to be left out of
    the scene but is not in it."""
    if settings.mode == "reference":
        raise InvalidSetting("a probe is for hybrid mode; reference mode has none", FIELD)
    if settings.bounces:
        raise InvalidSetting(
            "a probe takes the place of reflected rays; leave it out, or give 0", "settings.bounces"
        )
    for name in probe.without or ():
        _called(scene, name)
