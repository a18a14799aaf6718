"""An environment's summed-area tables: two equal-area cylinders, around +Y and around +X.

On Lambert's cylinder (azimuth across, the axis' coordinate down) every texel covers the same solid
angle, so the table needs no weights and a box needs no sine or arc cosine. Near its axis a
cylinder's boxes are slivers; there the other cylinder takes over, through a narrow band in which
the two are blended: none is used nearer than 43 degrees to its axis. Neither seam nor pole is
special.
"""

import math
from dataclasses import dataclass

import numpy as np

from raysvc.imaging.sat import summed_area_table
from raysvc.imaging.sat_orders import build_integrated
from raysvc.lighting.lat_long import texel_solid_angles
from raysvc.lighting.sphere_kernels import spread_to_x_cylinder
from raysvc.types import Doubles, Floats

MAX_COLUMNS = 2048
"""Texels around a cylinder: finer than half of the narrowest lobe that is filtered."""
MIN_COLUMNS = 64


@dataclass(frozen=True, slots=True, eq=False)
class SphereTable:
    """Both cylinders' tables, and how they were made."""

    tables: Doubles
    """(2, ...) read-only: the tables that `sat_orders.integrated` makes of both cylinders, images
    (rows, columns, 3) whose texels have the same solid angle. Row 0 is at +axis; the centre column
    is what is seen along -Z; to its right is +X around Y, and +Y around X."""
    passes: int
    """Of the builder over one of the tables, in all of its sums."""


def sphere_table(radiance: Floats, order: int = 1, builder: str = "fused") -> SphereTable:
    """Tables of a lat-long map (H, W, 3) for `sphere_kernels.narrow_radiance`.

    The cylinder around Y holds exactly the light of the map; the other one is resampled, the light
    of every texel shared out over the texels that it meets. Constant maps give constant tables.

    Parameters
    ----------
    order
        of the filters, 1 to 3
    builder
        of all sums, one of `sat_builders.BUILDERS`; they agree to rounding
    """
    columns = min(max(radiance.shape[1], MIN_COLUMNS), MAX_COLUMNS)
    rows = columns // 2
    shared = np.zeros((rows, columns, 4))
    height = len(radiance)
    detail = 2 if height >= rows else math.ceil(2 * rows / height)
    spread_to_x_cylinder(radiance, detail, shared)
    images = _y_cylinder(radiance, rows, columns, builder), _radiance_of_shares(shared)
    built = [build_integrated(image, order, builder=builder) for image in images]
    tables = np.stack([each.table for each in built])
    tables.setflags(write=False)
    return SphereTable(tables, built[0].passes)


def _y_cylinder(radiance: Floats, rows: int, columns: int, builder: str) -> Doubles:
    """Cylinder around Y (rows, columns, 3), read out of the map's own table."""
    height, width, _ = radiance.shape
    per_row = texel_solid_angles(height, width)
    table = summed_area_table(radiance * per_row[:, None, None], builder)
    # Sums grow linearly with the cosine inside a row of texels, and with the column
    edges = np.cos(np.arange(height + 1) * (math.pi / height))
    wanted = 1.0 - 2.0 * np.arange(rows + 1) / rows
    table = _interpolated(table, np.interp(-wanted, -edges, np.arange(height + 1)))
    if columns != width:
        across = np.arange(columns + 1) * (width / columns)
        table = _interpolated(table.transpose(1, 0, 2), across).transpose(1, 0, 2)
    image: Doubles = np.diff(np.diff(table, axis=0), axis=1) * (rows * columns / (4.0 * math.pi))
    return image


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
