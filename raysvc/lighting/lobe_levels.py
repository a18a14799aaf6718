"""An environment under round lobes, from narrow to wide ones.

What a rough surface shows of a map has no fine detail. So the map is cut off at a degree of the
spherical harmonics, filtered there exactly, and kept as small octahedral images, one per width.
"""

from typing import NamedTuple

import numpy as np

from raysvc.lighting.lobe_level_kernels import unfold
from raysvc.lighting.zonal import ZonalMap
from raysvc.types import Doubles, Floats, Ints

DEGREE = 128
"""Of the maps and of the narrowest lobes."""
FINE = (256, DEGREE)
COARSE = (96, 48)
"""Rows of the lat-long maps that levels are taken from, and their degree."""
NEGLIGIBLE = 3e-3
"""Coefficients of further degrees do not show."""


class LobeFamily(NamedTuple):
    """Round lobes, from narrow to wide ones in even steps of the solid angle's logarithm."""

    zonal: tuple[Doubles, ...]
    """Coefficients of each lobe, (DEGREE + 1,)."""
    sides: tuple[int, ...]
    """Texels of each level's image: their size is about a fifth of the lobe's width."""


class LobeLevels(NamedTuple):
    """Read-only arrays for `lobe_level_kernels.level_radiance`."""

    texels: Floats
    """(rows, columns, 3): the levels' octahedral images with borders below each other."""
    sides: Ints
    """(levels,) texels of each image without its border."""
    firsts: Ints
    """(levels,) first row of each image."""

    @staticmethod
    def of(harmonics: ZonalMap, family: LobeFamily) -> "LobeLevels":
        """Filter a map by all lobes of a family."""
        sides = np.array(family.sides, np.int32)
        firsts = np.concatenate([[0], np.cumsum(sides + 2)[:-1]]).astype(np.int32)
        texels = np.zeros((int((sides + 2).sum()), int(sides.max()) + 2, 3), np.float32)

        zonal = np.stack(family.zonal)
        coarse = (np.abs(zonal[:, COARSE[1] :]) < NEGLIGIBLE).all(axis=1)
        for (rows, degree), levels in ((FINE, ~coarse), (COARSE, coarse)):
            some = np.flatnonzero(levels)
            if not len(some):
                continue
            images = harmonics.filtered(zonal[some, : degree + 1], rows, 2 * rows)
            for k, image in zip(some, images.astype(np.float32), strict=True):
                unfold(image, int(sides[k]), int(firsts[k]), texels)
        texels.setflags(write=False)
        return LobeLevels(texels, sides, firsts)
