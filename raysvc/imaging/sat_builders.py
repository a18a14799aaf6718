"""Four ways to make the same summed-area table, which differ in passes over memory.

All write only what is their own from several threads, and make the same additions in the same order
with any number of them, and so the same bits. Images on a fixed-point grid, whose sums double
precision holds exactly, give the same bits with every builder.
"""

from collections.abc import Callable, Mapping
from typing import Final

import numpy as np

from raysvc.imaging.sat_doubling_kernels import add_from_above, add_from_the_left
from raysvc.imaging.sat_fused_kernels import accumulate, accumulate_first, accumulate_rgb
from raysvc.imaging.sat_scan_kernels import add_to_rows, scan_down, transpose
from raysvc.parallel import Control, for_chunks, for_waves
from raysvc.types import Doubles, Floats

Image = Floats | Doubles
Builder = Callable[[Image, Image, int, Control], int]
"""Fills rows and columns 1.. of a table (H+1, W+1, C), row and column 0 of which are zero, from an
image (H, W, C); takes samples per pass, which only doubling heeds; returns the passes it made."""

BLOCK_ROWS = 64
"""Rows of the fused pass after which a lane lets the next one follow."""
LANE_TEXELS = 1 << 16
"""Fewer texels than this for each lane are not worth a thread."""
STRIP_ROWS = 64
CHUNK_ROWS = 32
CHUNK_VALUES = 2048
"""Of a row, scanned down together."""


def fused(image: Image, table: Image, _: int, control: Control) -> int:
    """One pass: row sums added to the row above, lanes of columns one behind the other."""
    height, width, channels = image.shape
    lanes = max(min(control.threads, width, height * width // LANE_TEXELS), 1)
    edges = [width * lane // lanes for lane in range(lanes + 1)]
    running = np.zeros((height, channels), table.dtype)
    kernel = accumulate_rgb if channels == 3 else accumulate

    def work(lane: int, block: int) -> None:
        top = block * BLOCK_ROWS
        rows = top, min(top + BLOCK_ROWS, height)
        kernel(image, table, running, rows, (edges[lane], edges[lane + 1]))

    for_waves(lanes, -(-height // BLOCK_ROWS), work, control)
    return 1


def doubling(image: Image, table: Image, samples: int, control: Control) -> int:
    """Recursive doubling: ceil(log_k W) passes along the rows, ceil(log_k H) along the columns."""
    height, width, channels = image.shape
    rows, columns = _strides(height, samples), _strides(width, samples)
    # Passes read one array and write the other; the last one has to write the table
    here, there = table, np.zeros_like(table)
    if (len(rows) + len(columns)) % 2:
        here, there = there, here
    here[1:, 1:] = image
    passes = 0
    for kernel, stride in [
        *((add_from_the_left, stride * channels) for stride in columns),
        *((add_from_above, stride) for stride in rows),
    ]:
        _double(kernel, _rows_of(here), _rows_of(there), stride, samples, control)
        here, there = there, here
        passes += 1
    return passes


def scan(image: Image, table: Image, _: int, control: Control) -> int:
    """Four passes: scan down the columns, transpose, scan down the columns, transpose."""
    height, width, channels = image.shape
    down = np.empty((height, width, channels), table.dtype)
    across = np.empty((width, height, channels), table.dtype)
    _scan_down(image, down, control)
    _transpose(down, across, 0, control)
    _scan_down(across, across, control)
    _transpose(across, table, 1, control)
    return 4


def strips(image: Image, table: Image, _: int, control: Control) -> int:
    """Three passes: strips of rows apart, an exclusive scan of their last rows, resolving."""
    height, width, channels = image.shape
    running = np.zeros((height, channels), table.dtype)
    kernel = accumulate_rgb if channels == 3 else accumulate

    def alone(begin: int, end: int) -> None:
        accumulate_first(image, table, begin)
        kernel(image, table, running, (begin + 1, end), (0, width))

    for_chunks(height, STRIP_ROWS, alone, control)
    values = _rows_of(table)
    before = values[:height:STRIP_ROWS].copy()
    _scan_down(before, before, control)

    def resolve(begin: int, end: int) -> None:
        add_to_rows(values, before[begin // STRIP_ROWS], begin + 1, end + 1)

    for_chunks(height, STRIP_ROWS, resolve, control)
    return 3


BUILDERS: Final[Mapping[str, Builder]] = {
    "fused": fused,
    "doubling": doubling,
    "scan": scan,
    "strips": strips,
}


def _strides(length: int, samples: int) -> list[int]:
    """1, k, k^2 ... below a length."""
    strides = []
    stride = 1
    while stride < length:
        strides.append(stride)
        stride *= samples
    return strides


def _rows_of(values: Image) -> Image:
    """Rows of an array, flat."""
    return values.reshape(len(values), -1)


def _double(
    kernel: Callable[[Image, Image, int, int, int, int], None],
    source: Image,
    target: Image,
    stride: int,
    samples: int,
    control: Control,
) -> None:
    for_chunks(
        len(source),
        CHUNK_ROWS,
        lambda begin, end: kernel(source, target, stride, samples, begin, end),
        control,
    )


def _scan_down(source: Image, target: Image, control: Control) -> None:
    flat, sums = _rows_of(source), _rows_of(target)
    for_chunks(
        flat.shape[1],
        CHUNK_VALUES,
        lambda begin, end: scan_down(flat, sums, begin, end),
        control,
    )


def _transpose(source: Image, target: Image, first: int, control: Control) -> None:
    for_chunks(
        len(source),
        CHUNK_ROWS,
        lambda begin, end: transpose(source, target, first, begin, end),
        control,
    )
