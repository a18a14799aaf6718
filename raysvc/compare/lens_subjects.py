"""What the lens is measured on."""

from collections.abc import Mapping
from typing import Any

from raysvc.builtin import BUILTIN_ENVIRONMENTS
from raysvc.compare.lens_benchmark import LensSubject
from raysvc.frame.settings import Settings, checked
from raysvc.frame.view import View
from raysvc.loading import load_scene
from raysvc.scene import Environment


def lens_subjects(
    size: Mapping[str, Any], scene: str | None = None, environment: Environment | None = None
) -> dict[str, LensSubject]:
    """Return scenes seen through a lens, by name; with one more from a file.

    That one is looked at as glTF's sample DepthOfFieldExample asks for: its sun has 6,830 lux, and
    the sky is made as strong as belongs to it. An environment lights it, and lights `shiny` again:
    one with small lamps makes highlights.
    """

    def view(**fields: Any) -> View:
        return checked(View, {**fields, **size}, "camera")

    even = BUILTIN_ENVIRONMENTS["gradient"]()
    shiny = load_scene("builtin:shiny")
    close = view(gltf_camera=0, aperture_radius=0.12, focus_distance=7.6)
    far = view(gltf_camera=0, aperture_radius=0.12, focus_distance=4.6)
    fence = view(gltf_camera=0, aperture_radius=0.06, focus_distance=5.0)
    subjects = {
        "shiny_near": LensSubject(shiny, close, even),
        "shiny_far": LensSubject(shiny, far, even),
        "fence": LensSubject(load_scene("builtin:fence"), fence, even),
    }
    if environment is not None:
        subjects["shiny_near_lit"] = LensSubject(shiny, close, environment)
        subjects["shiny_far_lit"] = LensSubject(shiny, far, environment)
    if scene is not None:
        sample = view(eye=(0.9, 1.6, 3.6), target=(0.0, 0.5, 0.0), aperture_radius=0.1)
        settings = Settings(environment_strength=1000.0, exposure_stops=-11.0)
        subjects["file"] = LensSubject(load_scene(scene), sample, environment, settings)
    return subjects
