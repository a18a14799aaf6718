"""The stages of a frame, each a function from a draft of it to what it adds.

    rasterise -> layers -> shadows -> occlusion -> reflections -> light -> edges -> lens

Every stage is timed by the caller. Within a stage, chunks of points run on the frame's threads;
progress, cancelling and the deadline are looked at between them.
"""

from dataclasses import replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from raysvc.frame.antialias import antialias
from raysvc.frame.background import composite
from raysvc.frame.draft import Draft
from raysvc.frame.points import front
from raysvc.frame.primary import CHUNK, points_of, rasterised
from raysvc.frame.radiance import Reflection
from raysvc.lens.coc import coc_px
from raysvc.lens.spread import spread
from raysvc.parallel import for_chunks, map_chunks
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
    seen = draft.front >= 0
    index = draft.front[seen]
    triangle = points.triangle[index]

    def layer(values: NDArray[Any], empty: float) -> NDArray[Any]:
        full = np.full((len(seen), *values.shape[1:]), empty, values.dtype)
        full[seen] = values
        return full.reshape(*draft.shape, *values.shape[1:])

    draft.layers |= {
        "depth": layer(points.depth[index], np.inf),
        "normal": layer(points.surface.normal[index], 0.0),
        "albedo": layer(points.surface.base_colour[index], 0.0),
        "id": layer(triangle, -1),
        "object": layer(scene.object_of_triangle[triangle], -1),
        "material": layer(scene.material_of_triangle[triangle], -1),
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
    step[seen] = (points.footprint * (1.0 + 1.5 * slope))[index]
    return step.reshape(draft.shape)


def reflections(draft: Draft) -> None:
    """Trace mirror rays from shiny points."""
    points = draft.points

    def some(begin: int, end: int) -> Reflection:
        return draft.illumination.reflection(
            points.surface.rows(begin, end), points.footprint[begin:end], draft.settings.bounces
        )

    parts = map_chunks(len(points.pixel), CHUNK, some, draft.control, "reflections")
    parts = parts or [Reflection(np.zeros((0, 3), np.float32), np.zeros(0, np.float32))]
    draft.reflection = Reflection(
        np.concatenate([part.radiance for part in parts]),
        np.concatenate([part.share for part in parts]),
    )


def light(draft: Draft) -> None:
    """Add the environment's light, and put points and background together."""
    points = draft.points

    def some(begin: int, end: int) -> Floats:
        reflection = Reflection(
            draft.reflection.radiance[begin:end], draft.reflection.share[begin:end]
        )
        return draft.illumination.combined(
            points.surface.rows(begin, end),
            draft.direct[begin:end],
            draft.visible[begin:end],
            reflection,
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


STAGES: Final = (
    ("rasterise", rasterise),
    ("layers", write_layers),
    ("shadows", shadows),
    ("occlusion", occlusion),
    ("reflections", reflections),
    ("light", light),
    ("edges", antialias),
    ("lens", defocus),
)
