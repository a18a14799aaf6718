"""What the golden pictures show: scene, environment, view, settings; at most 96 x 64 pixels."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import raysvc
from raysvc.builtin import BUILTIN_ENVIRONMENTS, BUILTIN_SCENES
from tests.frame.subjects import still_life

WIDE = {"width": 96, "height": 54}


@dataclass(frozen=True)
class Subject:
    scene: Callable[[], raysvc.Scene]
    view: dict[str, Any]
    environment: str = "clear_sky"
    settings: dict[str, Any] = field(default_factory=dict)

    def render(self) -> raysvc.Frame:
        environment = BUILTIN_ENVIRONMENTS[self.environment]()
        return raysvc.render(self.scene(), environment, self.view, self.settings)


SUBJECTS = {
    "torus_park": Subject(BUILTIN_SCENES["torus_park"], WIDE | {"gltf_camera": "default"}),
    "shiny_in_studio": Subject(
        BUILTIN_SCENES["shiny"], WIDE | {"gltf_camera": "default"}, "studio", {"bounces": 3}
    ),
    "shiny_defocused": Subject(
        BUILTIN_SCENES["shiny"],
        WIDE | {"gltf_camera": "default", "aperture_radius": 0.12, "focus_distance": 4.0},
        "gradient",
    ),
    "cornell": Subject(
        BUILTIN_SCENES["cornell"],
        {"width": 54, "height": 54, "gltf_camera": "default"},
        settings={"environment_strength": 0.05},
    ),
    "cornell_by_paths": Subject(
        BUILTIN_SCENES["cornell"],
        {"width": 54, "height": 54, "gltf_camera": "default", "aperture_radius": 0.01},
        settings={"mode": "reference", "samples": 64, "environment_strength": 0.05},
    ),
    "still_life": Subject(
        still_life,
        WIDE | {"eye": [0.5, 2.0, 5.0], "target": [0.0, 0.6, 0.0]},
        settings={"aa": "full", "tone_map": "agx"},
    ),
}
