"""Reference mode's stage: the picture by random paths, anti-aliased and through the lens."""

from dataclasses import replace

import numpy as np

from raysvc.frame.draft import Draft
from raysvc.lens.coc import coc_px
from raysvc.parallel import for_chunks
from raysvc.reference.eye import camera_rays
from raysvc.reference.film import Film
from raysvc.reference.paths import IN_PIXEL, ON_LENS, Draws, PathTracer
from raysvc.reference.sequence_kernels import pixel_keys
from raysvc.types import Bools, Floats

PIXELS = 1 << 10
SAMPLES = 16
"""One wave of paths: so many pixels next to each other, so many samples of each."""


def paths(draft: Draft) -> None:
    """Follow `samples` paths from every pixel, some of each in turn, and average what they bring.

    A pixel's samples are spread evenly over its square and over the lens.
    """
    settings, camera, prepared = draft.settings, draft.camera, draft.prepared
    assert prepared.path_lights is not None
    if settings.lens == "none":
        camera = replace(camera, aperture_radius=0.0)
    tracer = PathTracer(
        prepared.world,
        prepared.tables,
        prepared.path_lights,
        settings.bounce_limit,
        draft.ledger.count,
        rescatters=settings.multiple_scattering,
    )
    key = np.empty(camera.width * camera.height, np.uint32)
    pixel_keys(np.arange(len(key), dtype=np.uint32), settings.seed, key)
    film = Film(len(key))
    for first in range(0, settings.samples, SAMPLES):
        last = min(first + SAMPLES, settings.samples)
        index = np.arange(first, last, dtype=np.uint32)

        def some(begin: int, end: int, index: np.ndarray = index) -> None:
            pixel = np.repeat(np.arange(begin, end), len(index))
            draws = Draws(key[pixel], np.tile(index, end - begin))
            within, on_lens = draws.pairs(IN_PIXEL) - 0.5, draws.pairs(ON_LENS)
            rays = camera_rays(camera, pixel, within, on_lens, settings.aperture)
            radiance, met = tracer.trace(rays, draws, draft.control)
            rgba = _over_background(draft, rays.directions, radiance, met)
            film.add(begin, end, rgba.reshape(end - begin, len(index), 4))

        part = first / settings.samples, last / settings.samples
        for_chunks(len(key), PIXELS, some, draft.control, "paths", part)
    draft.beauty = film.mean().reshape(*draft.shape, 4)
    if camera.aperture_radius > 0.0:
        coc = coc_px(camera, draft.layers["depth"])
        draft.layers["coc"] = coc
        draft.ledger.max_coc_px = float(np.abs(coc).max())


def _over_background(draft: Draft, directions: Floats, radiance: Floats, met: Bools) -> Floats:
    """Premultiplied RGBA (N, 4) of samples: radiance (N, 3) where anything was `met`, else what is
    behind the scene in `directions` (N, 3)."""
    rgba = np.ones((len(met), 4), np.float32)
    rgba[:, :3] = radiance
    background, missed = draft.settings.background, np.flatnonzero(~met)
    if background == "transparent":
        rgba[missed] = 0.0
    elif background == "environment":
        assert draft.prepared.path_lights is not None
        rgba[missed, :3], _ = draft.prepared.path_lights.environment.look_up(directions[missed])
    else:
        rgba[missed, :3] = np.array(background, np.float32)
    return rgba
