"""The stages of a frame, each a function from a draft of it to what it adds.

    rasterise -> surfaces -> shadows -> occlusion -> reflections -> light -> edges -> lens

Every stage is timed by the caller. Within a stage, chunks of points run on the frame's threads;
progress, cancelling and the deadline are looked at between them.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from raysvc.frame.background import composite
from raysvc.frame.points import Points, front
from raysvc.frame.prepared import Prepared
from raysvc.frame.primary import CHUNK, points_of, rasterised, traced
from raysvc.frame.radiance import Illumination, Reflection
from raysvc.frame.settings import Settings
from raysvc.frame.statistics import Ledger
from raysvc.lens.coc import coc_px
from raysvc.lens.spread import spread
from raysvc.parallel import Control, for_chunks, map_chunks
from raysvc.raster.edges import edge_mask
from raysvc.scene import Camera
from raysvc.tracing.occlusion import VisibilityPicture, tile_of
from raysvc.types import Bools, Doubles, Floats, Longs


@dataclass(slots=True, eq=False)
class Draft:
    """A frame in the making. Stages fill it from top to bottom; N points, H x W pixels."""

    prepared: Prepared
    camera: Camera
    settings: Settings
    control: Control
    ledger: Ledger
    illumination: Illumination
    points: Points = field(init=False)
    front: Longs = field(init=False)
    """(H * W,) which point stands for a pixel in the layers, or -1."""
    direct: Floats = field(init=False)
    visible: Floats = field(init=False)
    """(N,) ambient visibility."""
    visibility: VisibilityPicture = field(init=False)
    reflection: Reflection = field(init=False)
    beauty: Floats = field(init=False)
    """(H, W, 4) premultiplied linear RGBA."""
    layers: dict[str, NDArray[Any]] = field(default_factory=dict)

    @property
    def shape(self) -> tuple[int, int]:
        """H, W."""
        return self.camera.height, self.camera.width

    def each(
        self, work: Callable[[int, int], Floats], stage: str, channels: tuple[int, ...]
    ) -> Floats:
        """Join what `work` makes of chunks of the points: (N, *channels)."""
        parts = map_chunks(len(self.points.pixel), CHUNK, work, self.control, stage)
        return np.concatenate(parts) if parts else np.zeros((0, *channels), np.float32)


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
    """Find how much of the sky each point sees, smooth over neighbouring pixels."""
    points = draft.points
    tile = tile_of(points.pixel, draft.camera.width)
    draft.visible = draft.each(
        lambda begin, end: draft.illumination.occlusion(
            points.surface.rows(begin, end), tile[begin:end]
        ),
        "occlusion",
        (),
    )
    seen = draft.front >= 0
    index = draft.front[seen]
    picture = np.ones(len(seen), np.float32)
    picture[seen] = draft.visible[index]
    draft.visibility = VisibilityPicture(
        picture.reshape(draft.shape),
        draft.layers["depth"],
        draft.layers["normal"],
        _depth_step(draft),
    )
    if draft.settings.occlusion_samples:
        draft.visibility = draft.visibility.smooth()
        draft.visible[index] = draft.visibility.visible.reshape(-1)[seen]
    draft.layers["occlusion"] = draft.visibility.visible


def _depth_step(draft: Draft) -> Floats:
    """(H, W) metres that depth may change from a pixel to the next on the surface it shows."""
    surface, points = draft.points.surface, draft.points
    cosine = np.einsum("nk,nk->n", surface.geometric_normal, surface.view)
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

    radiance = draft.each(some, "light", (3,))
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


def antialias(draft: Draft) -> None:
    """Take more samples where the picture has edges, or everywhere, and average them."""
    settings = draft.settings
    flagged = _flagged(draft)
    draft.layers["edge"] = flagged.astype(np.float32)
    draft.ledger.edge_fraction = float(flagged.mean())
    pixel = np.flatnonzero(flagged)
    offsets = sample_offsets(settings.aa_samples)
    rgba = draft.beauty.reshape(-1, 4)

    def some(begin: int, end: int) -> None:
        total = np.zeros((end - begin, 4), np.float32)
        for number, (dx, dy) in enumerate(offsets):
            draft.control.check()
            camera = draft.camera.shifted(float(dx), float(dy))
            illumination = draft.illumination.share(number, len(offsets))
            total += _sampled(draft, illumination, camera, pixel[begin:end])
        rgba[pixel[begin:end]] = total / np.float32(len(offsets))

    for_chunks(len(pixel), CHUNK // 4, some, draft.control, "edges")


def _flagged(draft: Draft) -> Bools:
    aa = draft.settings.aa
    if aa == "none" or draft.settings.aa_samples == 1:
        return np.zeros(draft.shape, np.bool_)
    if aa == "full":
        return np.ones(draft.shape, np.bool_)
    layers = draft.layers
    materials = len(draft.prepared.scene.materials)
    part = np.where(layers["id"] >= 0, layers["object"] * materials + layers["material"], -1)
    return edge_mask(part.astype(np.int32), layers["depth"], layers["normal"])


def sample_offsets(count: int) -> Doubles:
    """(count, 2) places in a pixel, from its centre, evenly spread.

    The R2 sequence: Roberts 2018, "The Unreasonable Effectiveness of Quasirandom Sequences".
    """
    index = np.arange(1, count + 1)[:, None]
    offsets: Doubles = (
        0.5 + index * np.array([0.7548776662466927, 0.5698402909980532])
    ) % 1.0 - 0.5
    return offsets


def _sampled(draft: Draft, illumination: Illumination, camera: Camera, pixel: Longs) -> Floats:
    """Premultiplied RGBA (P, 4) of pixels (P,) seen through a camera that samples elsewhere in
    them."""
    draft.ledger.count("primary", len(pixel))
    points = traced(draft.prepared, camera, pixel, draft.settings.texture_filter)
    surface = points.surface
    radiance = illumination.combined(
        surface,
        illumination.direct(surface),
        _visible_at(draft, illumination, points),
        illumination.reflection(surface, points.footprint, draft.settings.bounces),
    )
    row = np.searchsorted(pixel, points.pixel)
    return composite(draft.prepared, camera, draft.settings, pixel, row, radiance, surface.alpha)


def _visible_at(draft: Draft, illumination: Illumination, points: Points) -> Floats:
    """Ambient visibility of samples beside pixel centres: the neighbours' where they show the same
    surface."""
    visible = draft.visibility.near(points.pixel, points.depth, points.surface.normal)
    alone = np.flatnonzero(visible < 0)
    tile = tile_of(points.pixel[alone], draft.camera.width)
    visible[alone] = illumination.occlusion(points.surface.chosen(alone), tile)
    return visible


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
