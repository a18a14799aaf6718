"""A sampled lens: the mean of pictures through a pinhole that stands at places all over it.

And a sampled pinhole: the mean of pictures from one place.

Haeberli and Akeley 1990, "The Accumulation Buffer: Hardware Support for High-Quality Rendering",
section 3.2. Every picture is shaded as any frame is; what one gets wrong by chance (shadows,
occlusion, edges: each has its own seed and its own place in the pixels) the mean evens out. Nothing
is approximated about the lens itself, and so this is what spreading is measured by.
"""

from typing import Final

import numpy as np

from raysvc.frame.draft import Draft
from raysvc.frame.peel import peel
from raysvc.frame.shared_rays import trace_beyond
from raysvc.frame.stages import gather_ambient, light, rasterise, shadows, write_layers
from raysvc.reference.eye import on_aperture
from raysvc.reference.sequence_kernels import pairs
from raysvc.types import Doubles, Floats

PINHOLE: Final = {"lens": "none", "aa": "none"}
"""How a picture's settings differ from the frame's."""
STAGES: Final = (rasterise, peel, write_layers, shadows, gather_ambient, trace_beyond, light)
IN_PIXEL, ON_LENS = range(2)


def through_lens(draft: Draft) -> Floats:
    """(H, W, 4) float32 premultiplied: the mean of `lens_samples` pictures through the lens.

    Light that surfaces send each other is taken from the frame, whose stages up to `light` must
    have run.
    """
    settings = draft.settings
    places = _points(settings.seed, ON_LENS, settings.lens_samples)
    return _mean(draft, on_aperture(settings.aperture, places), "lens")


def through_pinhole(draft: Draft) -> Floats:
    """The same of `aa_samples` pictures through the middle of the lens: anti-aliased wholly."""
    return _mean(draft, np.zeros((draft.settings.aa_samples, 2)), "edges")


def _mean(draft: Draft, on_lens: Doubles, stage: str) -> Floats:
    settings, control = draft.settings, draft.control.quiet()
    count = len(on_lens)
    in_pixel = _points(settings.seed, IN_PIXEL, count) - 0.5
    total = np.zeros((*draft.shape, 4))
    for number in range(count):
        control.check()
        draft.control.progress(stage, number / count)
        seed = (settings.seed + 1 + number) % (1 << 32)
        chosen = settings.model_copy(update={**PINHOLE, "seed": seed})
        camera = draft.camera.through_lens(*on_lens[number]).shifted(*in_pixel[number])
        illumination = draft.illumination.seeded(chosen)
        picture = Draft(
            draft.prepared,
            camera,
            chosen,
            control,
            draft.ledger,
            illumination,
            draft.rays.lit_by(illumination),
            draft.environment,
        )
        for fill in STAGES:
            fill(picture)
        total += picture.beauty
    draft.control.progress(stage, 1.0)
    mean: Floats = (total / count).astype(np.float32)
    return mean


def _points(seed: int, dimension: int, count: int) -> Doubles:
    """(count, 2) in 0..1, spread evenly."""
    points = np.empty((count, 2))
    key = np.full(count, seed, np.uint32)
    pairs(key, dimension, np.arange(count, dtype=np.uint32), points)
    return points
