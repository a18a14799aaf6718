"""Summed-area tables of a scene's textures, made when a frame first asks for them.

A table takes 32 bytes for every texel (four sums of 64 bits), eight times the texture. Together
they take MAX_BYTES at most: where that is not enough, the largest textures' tables are of a smaller
size of the texture, which then is the sharpest that `sat` shows of it.
"""

import heapq
import threading

import numpy as np

from raysvc.shading.material_table import (
    BASE_SLOT,
    EMISSIVE_SLOT,
    MaterialTable,
)
from raysvc.shading.texel_kernels import COLOUR, DATA, TextureTable
from raysvc.shading.texture_sum_kernels import TextureSums, accumulate
from raysvc.types import Ints

MAX_BYTES = 512 << 20
ENTRY_BYTES = 32
Use = tuple[int, int]
"""A texture, and as what it is read: DATA or COLOUR."""

NO_SUMS = TextureSums(
    np.zeros((1, 4), np.int64), np.full((1, 2), -1, np.int64), np.zeros((1, 2), np.int32)
)
"""For filters that read none."""


def texture_sums(
    materials: MaterialTable, textures: TextureTable, max_bytes: int = MAX_BYTES
) -> TextureSums:
    """Make the tables of all textures that slots of materials read, each as it is read."""
    uses = _uses(materials)
    level = _levels(uses, textures, max_bytes)
    start = np.full((len(textures.levels), 2), -1, np.int64)
    made: dict[tuple[int, int], int] = {}
    used = 0
    for texture, kind in uses:
        # Textures that share their texels share the table.
        texels = (int(textures.start[texture, 0]), kind)
        if texels not in made:
            made[texels] = used
            used += _entries(textures, texture, level[texture, kind])
        start[texture, kind] = made[texels]
    sums = np.zeros((max(used, 1), 4), np.int64)
    for texture, kind in uses:
        width, height = textures.size[texture, level[texture, kind]]
        first = int(textures.start[texture, level[texture, kind]])
        texels_of = textures.texels[first : first + width * height].reshape(height, width, 4)
        begin = int(start[texture, kind])
        table = sums[begin : begin + (height + 1) * (width + 1)]
        accumulate(texels_of, kind, textures.decoding, table.reshape(height + 1, width + 1, 4))
    return TextureSums(sums, start, level)


def _uses(materials: MaterialTable) -> list[Use]:
    found = {
        (int(texture), COLOUR if slot in (BASE_SLOT, EMISSIVE_SLOT) else DATA)
        for slots in materials.texture[:, :, 0]
        for slot, texture in enumerate(slots)
        if texture >= 0
    }
    return sorted(found)


def _levels(uses: list[Use], textures: TextureTable, max_bytes: int) -> Ints:
    """(T, 2) int32 size of each texture that its table is of, so that all fit."""
    level = np.zeros((len(textures.levels), 2), np.int32)
    largest = [(-_entries(textures, texture, 0), texture, kind) for texture, kind in uses]
    heapq.heapify(largest)
    total = -sum(entries for entries, _, _ in largest) * ENTRY_BYTES
    while total > max_bytes:
        entries, texture, kind = largest[0]
        if level[texture, kind] + 1 >= textures.levels[texture]:
            break
        level[texture, kind] += 1
        smaller = -_entries(textures, texture, level[texture, kind])
        total -= (smaller - entries) * ENTRY_BYTES
        heapq.heapreplace(largest, (smaller, texture, kind))
    return level


def _entries(textures: TextureTable, texture: int, level: int) -> int:
    width, height = textures.size[texture, level]
    return (int(width) + 1) * (int(height) + 1)


class LazySums:
    """The tables of a scene, made by the first thread that asks; the others wait for it."""

    def __init__(self, materials: MaterialTable, textures: TextureTable) -> None:
        self._materials, self._textures = materials, textures
        self._lock = threading.Lock()
        self._sums: TextureSums | None = None

    @property
    def are_made(self) -> bool:
        """Has anybody asked yet?"""
        return self._sums is not None

    def made(self) -> TextureSums:
        """Return the tables."""
        with self._lock:
            if self._sums is None:
                self._sums = texture_sums(self._materials, self._textures)
            return self._sums

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the tables, which must have been made, lack."""
        smaller = int((self.made().level > 0).any(axis=1).sum())
        if not smaller:
            return ()
        return (
            f"texture_filter: summed-area tables of {smaller} textures are of a smaller size, so"
            f" that all fit {MAX_BYTES >> 20} MiB; `sat` shows them less sharp",
        )
