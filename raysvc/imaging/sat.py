"""Summed-area tables: the mean of any box of an image for the cost of four reads (Crow 1984)."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from raysvc.errors import InvalidSetting
from raysvc.imaging.sat_builders import BUILDERS
from raysvc.imaging.sat_kernels import sum_boxes
from raysvc.parallel import Control
from raysvc.types import Doubles, Floats

SAMPLES = 2
"""Per pass of recursive doubling, where nothing else is asked for."""


@dataclass(frozen=True, slots=True, eq=False)
class BuiltTable:
    """A summed-area table, and how it was made."""

    table: Any
    """(H+1, W+1, C) as `summed_area_table` returns it."""
    builder: str
    passes: int
    """How many times memory was gone over."""


def summed_area_table(
    image: Floats | Doubles,
    builder: str = "fused",
    *,
    samples: int = SAMPLES,
    dtype: Any = np.float64,
    out: Any = None,
    control: Control | None = None,
) -> Any:
    """Sums of everything above and left of every texel's corner.

    Parameters
    ----------
    image
        (H, W, C) float32 or float64
    builder
        one of BUILDERS: `fused`, `doubling`, `scan` or `strips`. On a fixed-point grid, with sums
        that the table's dtype holds exactly, all give the same bits; else they agree to rounding
    samples
        that `doubling` adds in a pass, at least 2
    dtype
        float64, or float32 to see why not: docs/summed_area_tables.md
    out
        a table of this shape and dtype to write to, in one piece of memory; memory that was used
        before costs no page faults, which take longer than the sums
    control
        threads and stopping, one thread by default; the bits are the same with any number

    Returns
    -------
    (H+1, W+1, C) of `dtype`; entry (i, j) sums rows 0..i and columns 0..j exclusive, so that row 0
    and column 0 are zero and no box needs a special case at an edge. Raises InvalidSetting.
    """
    built = build_table(image, builder, samples=samples, dtype=dtype, out=out, control=control)
    return built.table


def build_table(
    image: Floats | Doubles,
    builder: str = "fused",
    *,
    samples: int = SAMPLES,
    dtype: Any = np.float64,
    out: Any = None,
    control: Control | None = None,
) -> BuiltTable:
    """Do as `summed_area_table` does, and say how many passes it took."""
    if builder not in BUILDERS:
        raise InvalidSetting(f"unknown {builder!r}; there is {', '.join(BUILDERS)}", "builder")
    if samples < 2:
        raise InvalidSetting(f"must be at least 2, is {samples}", "samples")
    wanted = np.dtype(dtype)
    if wanted not in (np.float32, np.float64):
        raise InvalidSetting(f"must be float32 or float64, is {wanted}", "dtype")
    image = _checked(image)
    height, width, channels = image.shape
    shape = (height + 1, width + 1, channels)
    if out is None:
        out = np.empty(shape, wanted)
    elif out.shape != shape or out.dtype != wanted or not out.flags.c_contiguous:
        raise InvalidSetting(f"must be {shape} of {wanted}, without gaps", "out")
    out[0] = 0.0
    out[:, 0] = 0.0
    if wanted == np.float32:
        # Sums are then in float32 too, which is the point of such a table
        image = image.astype(np.float32, copy=False)
    passes = BUILDERS[builder](image, out, samples, control or Control(threads=1))
    return BuiltTable(out, builder, passes)


def _checked(image: Any) -> Any:
    """An image whose sums can be made, in one piece of memory."""
    if image.ndim != 3 or 0 in image.shape or image.dtype not in (np.float32, np.float64):
        raise InvalidSetting(
            "must be (height, width, channels) float32 or float64, with something in it;"
            f" is {image.shape} {image.dtype}",
            "image",
        )
    return np.ascontiguousarray(image)


def box_sums(table: Floats | Doubles, boxes: Doubles) -> Doubles:
    """Sums of an image over boxes with fractional edges.

    Parameters
    ----------
    table
        (H+1, W+1, C) as `summed_area_table` returns it
    boxes
        (N, 4) top, left, bottom, right in texels from the image's corner; what lies outside the
        image is zero

    Returns
    -------
    (N, C) float64, exact for an image of constant texels
    """
    sums = np.empty((len(boxes), table.shape[2]))
    sum_boxes(table, np.ascontiguousarray(boxes, np.float64), sums)
    return sums
