"""The nearest triangle of every pixel, band by band."""

from collections.abc import Callable
from dataclasses import fields

import numpy as np

from raysvc.parallel import Control, for_chunks, map_chunks
from raysvc.raster.clip import clip
from raysvc.raster.project import project
from raysvc.raster.spans import Fragments, SetUp, fragments, set_up
from raysvc.scene import Camera, Scene
from raysvc.types import Bools, Ints

NOTHING = np.uint64(0xFFFFFFFFFFFFFFFF)
BAND_ROWS = 64
"""Rows worked on at once: bounds the memory for fragments, and lets threads share the work."""
TRIANGLES = 1 << 16
"""Triangles that are clipped and set up at once."""
NEAR_OF_DIAGONAL = 1e-6
"""The near plane, as a part of the scene's diagonal: as near as precision allows."""

Keys = np.ndarray[tuple[int], np.dtype[np.uint64]]


class Raster:
    """One camera's view of a scene's triangles, as a buffer of depth-and-triangle keys.

    Solid triangles are resolved on construction. Those that may have holes are handed out as
    fragments, for the caller to say where they are.
    """

    def __init__(
        self, scene: Scene, solid: Bools, double_sided: Bools, camera: Camera, control: Control
    ) -> None:
        """Rasterise; `solid` and `double_sided` are (F,) bool per triangle."""
        self._camera, self._control = camera, control
        bounds = scene.bounds()
        self._near = NEAR_OF_DIAGONAL * float(np.linalg.norm(bounds[1] - bounds[0]) + 1e-30)
        self._corners = project(scene.positions, camera)
        self._triangles, self._double_sided = scene.triangles, double_sided
        self._holed = np.flatnonzero(~solid).astype(np.int32)
        self._keys: Keys = np.full(camera.height * camera.width, NOTHING)
        self._each_band(
            np.flatnonzero(solid).astype(np.int32),
            lambda found, _: np.minimum.at(self._keys, found.pixel, found.key),
            "rasterise",
        )

    def nearer_fragments(self, triangles: Ints) -> Fragments:
        """Fragments of the given triangles that are nearer than what the buffer holds."""
        kept: dict[int, Fragments] = {}

        def keep(found: Fragments, band: int) -> None:
            nearer = found.key < self._keys[found.pixel]
            kept[band] = Fragments(found.pixel[nearer], found.triangle[nearer], found.key[nearer])

        self._each_band(triangles, keep, "")
        parts = [kept[band] for band in sorted(kept)]
        return Fragments(
            np.concatenate([p.pixel for p in parts] or [np.zeros(0, np.int64)]),
            np.concatenate([p.triangle for p in parts] or [np.zeros(0, np.int32)]),
            np.concatenate([p.key for p in parts] or [np.zeros(0, np.uint64)]),
        )

    def add(self, found: Fragments) -> None:
        """Let fragments into the buffer."""
        np.minimum.at(self._keys, found.pixel, found.key)

    def visible(self) -> Ints:
        """(H * W,) int32: the nearest triangle at the centre of each pixel, or -1."""
        triangle = (self._keys & np.uint64(0xFFFFFFFF)).astype(np.int64)
        return np.where(self._keys == NOTHING, -1, triangle).astype(np.int32)

    def _each_band(
        self, triangles: Ints, use: Callable[[Fragments, int], None], stage: str
    ) -> None:
        camera = self._camera
        if not len(triangles):
            return
        work = self._set_up(triangles)

        def band(begin: int, end: int) -> None:
            use(fragments(work, begin, end - 1, camera.width), begin)

        for_chunks(camera.height, BAND_ROWS, band, self._control, stage)

    def _set_up(self, triangles: Ints) -> SetUp:
        parts = map_chunks(
            len(triangles),
            TRIANGLES,
            lambda begin, end: self._set_up_some(triangles[begin:end]),
            self._control,
        )
        return SetUp(
            **{
                f.name: np.concatenate([getattr(part, f.name) for part in parts])
                for f in fields(SetUp)
            }
        )

    def _set_up_some(self, triangles: Ints) -> SetUp:
        camera = self._camera
        corners, source = clip(
            self._corners[self._triangles[triangles]], self._near, camera.width, camera.height
        )
        chosen = triangles[source]
        return set_up(
            corners,
            chosen,
            self._double_sided[chosen],
            camera.height,
            camera.projection == "perspective",
        )
