"""Asking the kernels of scattering: directions that are drawn, values, and claimed densities."""

import numpy as np

from raysvc.reference.choices import choices_of
from raysvc.reference.scattering_kernels import reflect_samples, scatter

CELLS = (24, 36)
"""Of the height and the turn of directions."""


def scattered(surface, rng):
    """Directions, throughput of white light, densities."""
    count = surface.size
    directions = np.empty((count, 3), np.float32)
    throughput, density = np.ones((count, 3), np.float32), np.empty(count)
    # An even lattice, so that means are those of many more samples
    index = np.arange(count)[:, None]
    place = (index * [0.7548776662466927, 0.5698402909980532] + rng.random(2)) % 1.0
    pick = (index[:, 0] * 0.6180339887498949 + rng.random()) % 1.0
    scatter(surface, choices_of(surface), place, pick, directions, throughput, density)
    return directions, throughput, density


def answered(surface, to_light):
    """BRDF times cosine towards directions (N, 3)."""
    count = surface.size
    white, value = np.ones((count, 3), np.float32), np.empty((count, 3), np.float32)
    reflect_samples(
        surface,
        choices_of(surface),
        np.ascontiguousarray(to_light, np.float32),
        white,
        np.full(count, np.inf),
        white,
        value,
    )
    return value


def densities(surface, to_light):
    """Density with which `scatter` draws directions (N, 3), from the weight of a light there."""
    count = surface.size
    white, value = np.ones((count, 3), np.float32), np.empty((count, 3), np.float32)
    own = np.full(count, 1.0)
    to_light = np.ascontiguousarray(to_light, np.float32)
    reflect_samples(surface, choices_of(surface), to_light, white, own, white, value)
    whole = answered(surface, to_light)
    seen = whole[:, 0] > 0
    weight = np.where(seen, value[:, 0].astype(float) / np.where(seen, whole[:, 0], 1), 1.0)
    return np.sqrt(np.maximum(1.0 / weight - 1.0, 0.0))


def counted_and_claimed(make, count, rng):
    """How many directions fall into each cell, how many should, and which (count,) are drawn.

    `make` gives a surface of so many points, all the same. Of each cell 64 places are looked at.
    """
    directions, throughput, density = scattered(make(count), rng)
    drawn = density > 0
    assert (throughput[~drawn] == 0).all()
    z = (np.arange(CELLS[0] * 8) + 0.5) / (CELLS[0] * 4) - 1
    azimuth = ((np.arange(CELLS[1] * 8) + 0.5) / (CELLS[1] * 8) - 0.5) * 2 * np.pi
    z, azimuth = (a.reshape(-1) for a in np.meshgrid(z, azimuth, indexing="ij"))
    sine = np.sqrt(1 - z**2)
    at = np.stack([sine * np.cos(azimuth), sine * np.sin(azimuth), z], axis=1)
    claimed = densities(make(len(at)), at)
    claimed = claimed.reshape(CELLS[0], 8, CELLS[1], 8).mean(axis=(1, 3)) * 4 * np.pi
    seen = directions[drawn].astype(float)
    turn = np.arctan2(seen[:, 1], seen[:, 0])
    counted = np.histogram2d(seen[:, 2], turn, CELLS, [[-1, 1], [-np.pi, np.pi]])[0]
    return counted, claimed / claimed.size * count, drawn
