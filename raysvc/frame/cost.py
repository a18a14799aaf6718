"""What a picture will cost, guessed before it is begun, so that what nobody could wait for is
refused at once.

The model is a sum of products, in seconds of one processor:

    hybrid      triangles TRIANGLE_S
                + pixels samples (SAMPLE_S + SHADOW_S + OCCLUSION_S + n OCCLUSION_RAY_S
                                  + bounces BOUNCE_S + (1 + bounces) BRUTE_S)
    reference   triangles TRIANGLE_S + pixels samples (PATH_S + bounces PATH_BOUNCE_S)

where in hybrid mode `samples` is 1 and EXTRA_SAMPLE of those that anti-aliasing adds (EDGE_SHARE of
them, if on edges only), or PICTURE of every picture that is accumulated, and terms of what is
turned off are left out. BOUNCE_S is another where something is transparent: then rays branch.

The numbers are from frames of the built-in scenes, 320 x 180 and 1280 x 720, one thread, on a
two-processor virtual machine of 2026 (`tests/frame/test_cost.py` renders some of them again). They
are meant to be right within a factor of four, above rather than below: a scene that fills the
picture costs more than one that leaves most of it empty, and another machine is another machine.
"""

from collections.abc import Iterator
from typing import Final

from raysvc.errors import LimitExceeded
from raysvc.frame.settings import Settings, accumulates
from raysvc.limits import Limits
from raysvc.scene import Camera, Scene

TRIANGLE_S: Final = 2e-6
"""Building a tree, and rasterising."""
SAMPLE_S: Final = 4e-6
SHADOW_S: Final = 2e-6
OCCLUSION_S: Final = 2e-6
OCCLUSION_RAY_S: Final = 0.1e-6
BOUNCE_S: Final = 1e-6
TRANSPARENT_BOUNCE_S: Final = 30e-6
BRUTE_S: Final = 60e-6
"""`ibl=brute`, for what is seen and for what is seen mirrored."""
EXTRA_SAMPLE: Final = 0.4
"""Of the cost of a pixel's first sample."""
EDGE_SHARE: Final = 0.1
PICTURE: Final = 0.5
"""Of the cost of a frame's samples."""
PATH_S: Final = 0.8e-6
PATH_BOUNCE_S: Final = 0.15e-6


def estimated_core_s(settings: Settings, camera: Camera, scene: Scene) -> float:
    """Seconds that one processor would take for a picture, roughly."""
    pixels, bounces = camera.width * camera.height, settings.bounce_limit
    fixed = TRIANGLE_S * len(scene.triangles)
    if settings.mode == "reference":
        return fixed + pixels * settings.samples * (PATH_S + bounces * PATH_BOUNCE_S)
    transparent = any(
        material.transmission > 0 or material.alpha_mode == "blend" for material in scene.materials
    )
    sample = SAMPLE_S + bounces * (TRANSPARENT_BOUNCE_S if transparent else BOUNCE_S)
    if settings.shadows:
        sample += SHADOW_S
    if settings.occlusion_samples:
        sample += OCCLUSION_S + settings.occlusion_samples * OCCLUSION_RAY_S
    if settings.ibl == "brute":
        sample += (1 + bounces) * BRUTE_S
    return fixed + pixels * _samples(settings, camera) * sample


def check_estimate(settings: Settings, camera: Camera, scene: Scene, limits: Limits) -> None:
    """Raise LimitExceeded if a picture would cost too much, naming what to ask less of."""
    most = limits.max_render_core_s
    estimate = estimated_core_s(settings, camera, scene)
    if estimate <= most:
        return
    enough = (
        field
        for field, lower in _lowered(settings)
        if estimated_core_s(lower, camera, scene) <= most
    )
    raise LimitExceeded(
        f"the picture would take about {estimate:,.0f} seconds of a processor; the limit is "
        f"{most:,g} (RAYSVC_MAX_RENDER_CORE_S)",
        next(enough, "camera.width"),
    )


def _samples(settings: Settings, camera: Camera) -> float:
    """Samples per pixel, in terms of the first; one of each picture that is accumulated."""
    pictures = settings.lens_samples if accumulates(settings, camera) else 0
    if settings.aa == "accumulate":
        pictures = max(pictures, settings.aa_samples)
    if pictures:
        return 1.0 + PICTURE * pictures
    if not settings.shades_samples:
        return 1.0
    share = 1.0 if settings.aa == "full" else EDGE_SHARE
    return 1.0 + EXTRA_SAMPLE * share * (settings.aa_samples - 1)


def _lowered(settings: Settings) -> Iterator[tuple[str, Settings]]:
    """What each setting could be lowered to, beginning with those that change a picture least."""
    lowest: dict[str, int | str] = {"samples": 1} if settings.mode == "reference" else {}
    if settings.mode == "hybrid":
        lowest = {"ibl": "sat", "lens_samples": 1, "aa_samples": 1, "occlusion_samples": 0}
    for name, value in (lowest | {"bounces": 0}).items():
        yield f"settings.{name}", settings.model_copy(update={name: value})
