"""A hybrid picture beside the path-traced one of the same scene, camera and light."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Final

import numpy as np

from raysvc.compare.machine import machine
from raysvc.compare.picture_difference import PictureDifference, picture_difference
from raysvc.frame.frame import Frame
from raysvc.frame.probe import Probe
from raysvc.frame.render import render
from raysvc.frame.settings import Settings, settings_from
from raysvc.frame.surroundings import DEFAULT_ENVIRONMENT, default_environment, surroundings
from raysvc.frame.view import View
from raysvc.imaging.encode import encode_png
from raysvc.parallel import Control
from raysvc.scene import Environment, Scene
from raysvc.types import Bytes
from raysvc.version import VERSION

HOW_NOT_WHAT: Final = frozenset({"mode", "samples", "bounces"})
"""Settings of the hybrid picture that the reference does not take over: it is to be the truth, and
as deep as it is by default."""


@dataclass(frozen=True, slots=True, eq=False)
class PictureComparison:
    """Two pictures and how they differ."""

    scene: str
    environment: str
    probe: Probe | None
    """Of the hybrid picture."""
    camera: View
    settings: Settings
    """Of the hybrid picture."""
    reference_settings: Settings
    difference: PictureDifference
    seconds: float
    reference_seconds: float
    warnings: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """Return plain lists, numbers and strings, ready for JSON."""
        height, width = self.difference.flip_map.shape
        return {
            "scene": self.scene,
            "environment": self.environment,
            "probe": None if self.probe is None else self.probe.model_dump(mode="json"),
            "width": width,
            "height": height,
            "camera": self.camera.model_dump(mode="json", exclude_none=True),
            "settings": self.settings.model_dump(mode="json"),
            "reference_settings": self.reference_settings.model_dump(mode="json"),
            **asdict(self.difference.figures),
            "seconds": self.seconds,
            "reference_seconds": self.reference_seconds,
            "warnings": list(self.warnings),
            "machine": machine(),
            "renderer_version": VERSION,
        }


def compare_pictures(
    scene: Scene,
    environment: Environment | Mapping[str, Any] | None = None,
    camera: View | None = None,
    settings: Settings | Mapping[str, Any] | None = None,
    samples: int | None = None,
    *,
    source: str = "",
    environment_source: str = "",
    control: Control | None = None,
) -> PictureComparison:
    """Render a scene as asked and in reference mode, and compare the two.

    Parameters
    ----------
    scene, environment, camera, settings
        as for `render`; the reference is without a probe, as what the probe's picture should be
    samples
        of the reference, per pixel; by default those of the settings
    source, environment_source
        where scene and light come from, for the answer

    Raises what `render` raises.
    """
    settings, camera = settings_from(settings), camera or View()
    true = reference_settings(settings, samples)
    control = control or Control()
    base, probe = surroundings(environment)
    named = f"builtin:{DEFAULT_ENVIRONMENT}" if base is default_environment() else base.name
    frame = render(scene, environment, camera, settings, control=control)
    reference = render(scene, base, camera, true, control=control)
    return PictureComparison(
        scene=source or scene.name,
        environment=environment_source or named,
        probe=probe,
        camera=camera,
        settings=settings,
        reference_settings=true,
        difference=frame_difference(frame, reference, control),
        seconds=frame.statistics.total_seconds,
        reference_seconds=reference.statistics.total_seconds,
        warnings=tuple(dict.fromkeys((*frame.statistics.warnings, *reference.statistics.warnings))),
    )


def reference_settings(settings: Settings, samples: int | None = None) -> Settings:
    """Settings of the picture that one with `settings` should be."""
    kept = settings.model_dump(exclude_unset=True, exclude=set(HOW_NOT_WHAT))
    asked = {} if samples is None else {"samples": samples}
    return settings_from({**kept, "mode": "reference", **asked})


def frame_difference(
    frame: Frame, reference: Frame, control: Control | None = None
) -> PictureDifference:
    """Compare two frames as the first one's settings display them."""
    return picture_difference(
        frame.layers["beauty"],
        reference.layers["beauty"],
        frame.settings.tone_map,
        frame.settings.exposure_stops,
        control,
    )


def difference_picture(difference: PictureDifference) -> Bytes:
    """(H, 3 W, 3) the picture, its reference, and FLIP in the colours of its authors: black is
    alike, through violet and orange to white."""
    from matplotlib import colormaps

    codes = np.rint(np.clip(difference.flip_map, 0.0, 1.0) * 255).astype(np.uint8)
    magma: Bytes = colormaps["magma"](codes, bytes=True)[..., :3]
    return np.hstack([difference.picture, difference.reference, magma])


def difference_png(difference: PictureDifference) -> bytes:
    """PNG of `difference_picture`."""
    return encode_png(difference_picture(difference))
