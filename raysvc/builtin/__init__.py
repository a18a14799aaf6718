"""Scenes and environments made in code: the same on every machine, with no file to fetch."""

from collections.abc import Callable, Mapping
from types import MappingProxyType

from raysvc.builtin.clear_sky import clear_sky
from raysvc.builtin.cornell import cornell
from raysvc.builtin.fence import fence
from raysvc.builtin.glass import glass
from raysvc.builtin.gradient import gradient
from raysvc.builtin.shiny import shiny
from raysvc.builtin.studio import studio
from raysvc.builtin.torus_park import torus_park
from raysvc.scene import Environment, Scene

BUILTIN_SCENES: Mapping[str, Callable[[], Scene]] = MappingProxyType(
    {
        "torus_park": torus_park,
        "shiny": shiny,
        "glass": glass,
        "cornell": cornell,
        "fence": fence,
    }
)
"""Every built-in scene by name; each has a camera named "default"."""

BUILTIN_ENVIRONMENTS: Mapping[str, Callable[[], Environment]] = MappingProxyType(
    {
        "clear_sky": clear_sky,
        "studio": studio,
        "gradient": gradient,
    }
)
"""Every built-in environment by name."""

__all__ = ["BUILTIN_ENVIRONMENTS", "BUILTIN_SCENES"]
