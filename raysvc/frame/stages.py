"""The stages of a frame, each a function from a draft of it to what it adds.

    hybrid      rasterise -> layers -> shadows -> occlusion -> reflections -> light -> edges -> lens
    reference   rasterise -> layers -> paths

Every stage is timed by the caller. Within a stage, chunks of points run on the frame's threads;
progress, cancelling and the deadline are looked at between them.
"""

from dataclasses import replace
from typing import Final

import numpy as np

from raysvc import records
from raysvc.frame.antialias import antialias
from raysvc.frame.background import composite
from raysvc.frame.draft import Draft
from raysvc.frame.paths import paths
from raysvc.frame.points import front
from raysvc.frame.primary import CHUNK, points_of, rasterised
from raysvc.frame.reflections import leaving
from raysvc.frame.shared_rays import trace_beyond
from raysvc.lens.coc import coc_px
from raysvc.lens.spread import spread
from raysvc.parallel import for_chunks
from raysvc.tracing.occlusion import VisibilityPicture, is_traced, tile_of
from raysvc.types import Floats, Longs


def rasterise(draft: Draft) -> None:
    """Find what each pixel shows, and evaluate materials there."""
    pixel, triangle = rasterised(draft.prepared, draft.camera, draft.control)
    draft.points = points_of(
        draft.prepared,
        draft.camera,
        pixel,
        triangle,
        draft.settings.texture_filter,
        draft.control,
        "surfaces",
    )
    draft.front = front(draft.points, draft.camera.width * draft.camera.height)


def write_layers(draft: Draft) -> None:
    """Lay out what is known of each pixel's point."""
    points, scene = draft.points, draft.prepared.scene
    draft.layers |= {
        "depth": draft.picture(points.depth, np.inf),
        "normal": draft.picture(points.surface.normal, 0.0),
        "albedo": draft.picture(points.surface.base_colour, 0.0),
        "id": draft.picture(points.triangle, -1),
        "object": draft.picture(scene.object_of_triangle[points.triangle], -1),
        "material": draft.picture(scene.material_of_triangle[points.triangle], -1),
    }


def shadows(draft: Draft) -> None:
    """Light the points by the sun and punctual lights."""
    surface = draft.points.surface
    draft.direct = draft.each(
        lambda begin, end: draft.illumination.direct(surface.rows(begin, end)), "shadows", (3,)
    )


def occlusion(draft: Draft) -> None:
    """Find how much of the sky each point sees: by rays from some, by its neighbours for others."""
    points, width = draft.points, draft.camera.width
    in_front = np.zeros(len(points.pixel), np.bool_)
    in_front[draft.front[draft.front >= 0]] = True
    traced = ~in_front | is_traced(points.pixel, width)
    draft.visible = np.full(len(points.pixel), -1.0, np.float32)
    _trace_occlusion(draft, np.flatnonzero(traced), "occlusion")
    known = VisibilityPicture(
        _by_pixel(draft),
        draft.layers["depth"],
        draft.layers["normal"],
        _depth_step(draft),
    )

    def fill(begin: int, end: int) -> Floats:
        normal = points.surface.normal[begin:end]
        return known.around(points.pixel[begin:end], points.depth[begin:end], normal)

    filled = draft.each(fill, "", ())
    draft.visible[in_front] = filled[in_front]
    _trace_occlusion(draft, np.flatnonzero(draft.visible < 0), "")
    draft.visibility = replace(known, visible=_by_pixel(draft))
    draft.layers["occlusion"] = np.where(
        draft.front.reshape(draft.shape) >= 0, draft.visibility.visible, np.float32(1.0)
    )


def _trace_occlusion(draft: Draft, index: Longs, stage: str) -> None:
    """Trace occlusion rays from some of the points."""
    points = draft.points
    tile = tile_of(points.pixel[index], draft.camera.width)

    def trace(begin: int, end: int) -> None:
        some = index[begin:end]
        surface = points.surface.chosen(some)
        draft.visible[some] = draft.illumination.occlusion(surface, tile[begin:end])

    for_chunks(len(index), CHUNK // 4, trace, draft.control, stage)


def _by_pixel(draft: Draft) -> Floats:
    """(H, W) visibility of the points in front, -1 where it is not known yet."""
    seen = draft.front >= 0
    picture = np.full(len(seen), -1.0, np.float32)
    picture[seen] = draft.visible[draft.front[seen]]
    return picture.reshape(draft.shape)


def _depth_step(draft: Draft) -> Floats:
    """(H, W) metres that depth may change from a pixel to the next on the surface it shows."""
    surface, points = draft.points.surface, draft.points
    cosine = np.einsum("nk,nk->n", surface.geometric_normal, surface.to_viewer)
    slope = np.sqrt(np.maximum(1.0 - cosine**2, 0.0)) / np.maximum(cosine, 0.05)
    step = np.full(len(draft.front), np.inf, np.float32)
    seen = draft.front >= 0
    index = draft.front[seen]
    step[seen] = (draft.camera.pixel_width_m(points.depth) * (1.0 + 1.5 * slope))[index]
    return step.reshape(draft.shape)


def light(draft: Draft) -> None:
    """Add the environment's light, and put points and background together."""
    points = draft.points

    def some(begin: int, end: int) -> Floats:
        lit = draft.illumination.lit(
            points.surface.rows(begin, end),
            records.rows(points.footprint, begin, end),
            draft.direct[begin:end],
            draft.visible[begin:end],
        )
        return leaving(
            lit,
            records.rows(draft.reflection, begin, end),
            records.rows(draft.transmission, begin, end),
        )

    draft.radiance = radiance = draft.each(some, "light", (3,))
    pixel = np.arange(len(draft.front))
    row = points.pixel
    starts = np.searchsorted(row, np.arange(0, len(pixel) + CHUNK, CHUNK))
    rgba = np.empty((len(pixel), 4), np.float32)

    def compose(begin: int, end: int) -> None:
        first, last = starts[begin // CHUNK], starts[begin // CHUNK + 1]
        rgba[begin:end] = composite(
            draft.prepared,
            draft.camera,
            draft.settings,
            pixel[begin:end],
            row[first:last] - begin,
            radiance[first:last],
            points.surface.alpha[first:last],
        )

    for_chunks(len(pixel), CHUNK, compose, draft.control)
    draft.beauty = rgba.reshape(*draft.shape, 4)


def defocus(draft: Draft) -> None:
    """Give the picture a lens, if the camera has one."""
    if draft.settings.lens == "none" or draft.camera.aperture_radius == 0.0:
        return
    coc = coc_px(draft.camera, draft.layers["depth"])
    draft.layers["coc"] = coc
    draft.ledger.max_coc_px = float(np.abs(coc).max())
    draft.beauty = spread(draft.beauty, coc, draft.control, draft.ledger.warnings)


STAGES: Final = {
    "hybrid": (
        ("rasterise", rasterise),
        ("layers", write_layers),
        ("shadows", shadows),
        ("occlusion", occlusion),
        ("reflections", trace_beyond),
        ("light", light),
        ("edges", antialias),
        ("lens", defocus),
    ),
    "reference": (
        ("rasterise", rasterise),
        ("layers", write_layers),
        ("paths", paths),
    ),
}
"""What is done in each mode, in order."""
