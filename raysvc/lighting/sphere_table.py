"""An environment's summed-area tables: two equal-area cylinders, around +Y and around +X.

On Lambert's cylinder (azimuth across, the axis' coordinate down) every texel covers the same solid
angle, so the table needs no weights and a box needs no sine or arc cosine. Near its axis a
cylinder's boxes are slivers; there the other cylinder takes over, through a band in which the two
are blended: none is used nearer than 35 degrees to its axis. Neither seam nor pole is special.
"""

import math
from dataclasses import dataclass

import numpy as np

from raysvc.imaging.sat import summed_area_table
from raysvc.lighting.lat_long import texel_solid_angles
from raysvc.lighting.sphere_kernels import (
    SOFT_LEVELS,
    SOFT_SIDE,
    soften,
    spread_to_x_cylinder,
)
from raysvc.types import Doubles, Floats

MAX_COLUMNS = 2048
"""Texels around a sharp cylinder: finer than half of the narrowest lobe that is filtered."""
SOFT_COLUMNS = 256


@dataclass(frozen=True, slots=True, eq=False)
class SphereTable:
    """Read-only tables for `sphere_kernels.mean_radiance`, as `summed_area_table` makes them.

    All are (H+1, W+1, 3) float64 over an image whose texels have the same solid angle. Row 0 is at
    +axis; the centre column is what is seen along -Z; to its right is +X around Y, and +Y around X.
    """

    sharp: Doubles
    """(2, H+1, W+1, 3): the map on the cylinder around Y, and on that around X."""
    soft: Doubles
    """(2 SOFT_LEVELS, 129, 257, 3): both cylinders of a blurred map, for each level."""

    @staticmethod
    def of(radiance: Floats) -> "SphereTable":
        """Build the tables of a lat-long map (H, W, 3) float32 as `Environment` holds it.

        The one around Y holds exactly the light of the map; the other one is resampled, the light
        of every texel shared out over the texels that it meets. Constant maps give constant tables.
        """
        height, width, _ = radiance.shape
        columns = min(max(width, 64), MAX_COLUMNS)
        rows = max(columns // 2, 32)
        shared = np.zeros((rows, columns, 4))
        detail = 2 if height >= rows else math.ceil(2 * rows / height)
        spread_to_x_cylinder(radiance, detail, shared)
        sharp = np.stack(
            [
                _resampled_to_y_cylinder(radiance, rows, columns),
                summed_area_table(_radiance_of_shares(shared)),
            ]
        )
        soft = np.concatenate([_softened(sharp, SOFT_SIDE * 2.0**k) for k in range(SOFT_LEVELS)])
        for tables in (sharp, soft):
            tables.setflags(write=False)
        return SphereTable(sharp, soft)


def _softened(sharp: Doubles, side: float) -> Doubles:
    """Tables (2, 129, 257, 3) of the map under two boxes that together blur like one of `side`."""
    images = np.empty((2, SOFT_COLUMNS // 2, SOFT_COLUMNS, 3))
    tables = sharp
    for _ in range(2):
        soften(tables, 0.5 * side * side, images)
        tables = np.stack([summed_area_table(image) for image in images])
    return tables


def _resampled_to_y_cylinder(radiance: Floats, rows: int, columns: int) -> Doubles:
    """Table (rows+1, columns+1, 3) of the cylinder around Y, read out of the map's own table."""
    height, width, _ = radiance.shape
    per_row = texel_solid_angles(height, width)
    table = summed_area_table(radiance * per_row[:, None, None])
    # Sums grow linearly with the cosine inside a row of texels, and with the column
    edges = np.cos(np.arange(height + 1) * (math.pi / height))
    wanted = 1.0 - 2.0 * np.arange(rows + 1) / rows
    table = _interpolated(table, np.interp(-wanted, -edges, np.arange(height + 1)))
    if columns != width:
        across = np.arange(columns + 1) * (width / columns)
        table = _interpolated(table.transpose(1, 0, 2), across).transpose(1, 0, 2)
    return np.ascontiguousarray(table) * (rows * columns / (4.0 * math.pi))


def _interpolated(table: Doubles, positions: Doubles) -> Doubles:
    """Rows of a table (R, ...) at fractional positions (K,) within 0..R-1: (K, ...)."""
    below = np.minimum(positions.astype(np.int64), len(table) - 2)
    part = (positions - below).reshape(-1, *[1] * (table.ndim - 1))
    result: Doubles = table[below] * (1.0 - part) + table[below + 1] * part
    return result


def _radiance_of_shares(shared: Doubles) -> Doubles:
    """Divide light (rows, columns, RGB + solid angle) by solid angle; (rows, columns, 3).

    Close to the axis texels are slivers that nothing may have met: they take the mean of their row.
    """
    covered = shared[..., 3:]
    means = shared.sum(axis=1, keepdims=True)
    means = means[..., :3] / np.maximum(means[..., 3:], 1e-30)
    met = covered > 0.05 * 4.0 * math.pi / covered.size
    return np.where(met, shared[..., :3] / np.maximum(covered, 1e-30), means)
