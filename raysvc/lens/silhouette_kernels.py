"""Kernels that look for silhouettes in circles of confusion."""

from raysvc.jit import inlined, kernel
from raysvc.types import Bools, Floats

TILE = 8
STEP_PX = 1.0
"""Blurs of neighbours that differ by less are of one surface that recedes."""
OCTAVES = 24
"""Of reach: number k is up to 2^(k + 1) pixels."""


@inlined
def slice_of(coc: float, fade_end: Floats) -> int:
    """The nearer of the one or two slices of a diameter."""
    k = 0
    while k < len(fade_end) and fade_end[k] <= coc:
        k += 1
    return k


@inlined
def is_beyond(coc: float, other: float, fade_begin: Floats, fade_end: Floats) -> bool:
    """Is `other` in no slice that `coc` is in, but in farther ones, and well behind it?"""
    if other - coc < STEP_PX:
        return False
    k = 0
    while k < len(fade_begin) and fade_begin[k] < coc:
        k += 1
    return bool(k < len(fade_end) and other >= fade_end[k])


@kernel
def mark_silhouettes(coc_px: Floats, fade_begin: Floats, fade_end: Floats, seeds: Bools) -> None:
    """Set seeds (S, OCTAVES, tiles down, tiles across) where pixels are before others beside them.

    By slice of what is behind, and by how far both are blurred together.
    """
    height, width = coc_px.shape
    for y in range(height):
        for x in range(width):
            here = coc_px[y, x]
            for right in range(2):
                v, u = y + 1 - right, x + right
                if v >= height or u >= width:
                    continue
                there = coc_px[v, u]
                near, far = min(here, there), max(here, there)
                if not is_beyond(near, far, fade_begin, fade_end):
                    continue
                reach = 0.5 * (abs(near) + abs(far)) + 1.0
                octave = 0
                while reach > 2.0 and octave < OCTAVES - 1:
                    reach *= 0.5
                    octave += 1
                seeds[slice_of(far, fade_end), octave, y // TILE, x // TILE] = True


@kernel
def mark_hiding(
    coc_px: Floats, fade_begin: Floats, fade_end: Floats, reached: Bools, mask: Bools
) -> None:
    """Set mask (H, W) where pixels are before a slice of which a silhouette is within reach.

    reached: (S, tiles down, tiles across), by slice of what is behind the silhouette.
    """
    height, width = coc_px.shape
    slices = len(reached)
    for y in range(height):
        for x in range(width):
            last = 0
            while last < slices - 1 and fade_begin[last] < coc_px[y, x]:
                last += 1
            for k in range(last + 1, slices):
                if reached[k, y // TILE, x // TILE]:
                    mask[y, x] = True
                    break
