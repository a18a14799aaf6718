"""Scenes by name, and deformed shapes of them, which are scenes with names of their own.

A shape's folder holds the files of the scene that it was made from and one with its positions, so
it outlives that scene. While another shape of the scene is in memory it is made from that: they
then share textures, and their trees are moved from one to the other.
"""

import hashlib
import time
import weakref
from collections.abc import Callable, Collection, Sequence
from pathlib import Path
from typing import Final

import numpy as np

from raysvc.jobs.store import UNBOUNDED, ContentStore, Kind, Record, Upload
from raysvc.loading.scene_file import BUILTIN_PREFIX
from raysvc.loading.shape_file import Shape, npz_of, read_shape
from raysvc.scene import Scene
from raysvc.scene.rest_shape import given_normals, moved_positions
from raysvc.version import VERSION

SHAPE_FILE: Final = "shape.npz"
"""The last file of a deformed scene."""


class SceneStore(ContentStore[Scene]):
    """Immutable scenes by name, as they were sent and in other shapes."""

    def __init__(
        self,
        folder: Path,
        kind: Kind[Scene],
        memory_bytes: int,
        disk_bytes: int = UNBOUNDED,
        needed: Callable[[], Collection[str]] = frozenset[str],
    ) -> None:
        super().__init__(folder, kind, memory_bytes, disk_bytes, needed)
        self._kin: weakref.WeakValueDictionary[str, Scene] = weakref.WeakValueDictionary()
        """By the name of the scene at rest, the shape of it that was last in use."""

    def add_shape(self, id: str, shape: Shape) -> tuple[Record, bool]:
        """Keep a scene with its vertices elsewhere; returns the record and whether it is new.

        The same positions are one scene, whichever shape of it they are sent for. Raises NotFound,
        and what `Scene.deformed` does.
        """
        scene, origin = self.get(id), self.record(id)
        vertices = len(scene.positions)
        shape = Shape(
            moved_positions(shape.positions, vertices),
            None if shape.normals is None else given_normals(shape.normals, vertices),
        )
        rest = origin.rest or origin.id
        if shape.normals is None and np.array_equal(shape.positions, scene.rest.positions):
            at_rest = self._records.get(rest)
            if at_rest is not None:
                return at_rest, False
        name = _name_of(rest, shape)
        known = self._records.get(name)
        if known is not None:
            return known, False
        deformed = scene.deformed(shape.positions, shape.normals)
        record = Record(
            name,
            time.time(),
            self._kind.summarise(deformed),
            main=origin.main,
            files=(*_files_at_rest(origin), SHAPE_FILE),
            rest=rest,
            rest_builtin=origin.builtin or origin.rest_builtin,
        )
        links = [self._folder / id / str(n) for n in range(len(record.files) - 1)]
        kept = self._keep(record, deformed, [*links, npz_of(shape)])
        self._kin[rest] = deformed
        return kept

    def get(self, id: str) -> Scene:
        """Return the scene, loaded again if it had to make room. Raises NotFound."""
        scene = super().get(id)
        self._kin[self.record(id).rest or id] = scene
        return scene

    def _load(self, record: Record) -> Scene:
        if record.rest is None:
            return super()._load(record)
        *files, shape = self._read(record)
        kin = self._parsed.get(record.rest) or self._kin.get(record.rest)
        if kin is None:
            kin = self._at_rest(record, files)
        moved = read_shape(shape, len(kin.positions))
        return kin.deformed(moved.positions, moved.normals)

    def _at_rest(self, record: Record, files: Sequence[bytes]) -> Scene:
        """The scene as it was made, from its files (all but the last of the record's)."""
        if record.rest_builtin is not None:
            return self._kind.load(BUILTIN_PREFIX + record.rest_builtin)
        named = dict(zip(record.files, files, strict=False))
        return self._kind.load(Upload(named, record.main))


def _files_at_rest(record: Record) -> tuple[str, ...]:
    return record.files if record.rest is None else record.files[:-1]


def _name_of(rest: str, shape: Shape) -> str:
    """SHA-256 in hex of the scene and the numbers; also of the version, which orders vertices."""
    digest = hashlib.sha256(f"shape\0{rest}\0{VERSION}\0".encode())
    digest.update(np.ascontiguousarray(shape.positions, "<f4").tobytes())
    if shape.normals is not None:
        digest.update(np.ascontiguousarray(shape.normals, "<f4").tobytes())
    return digest.hexdigest()
