"""Integrals over the cosine-weighted hemisphere, on a fine grid of its unit disk (Nusselt's)."""

import numpy as np


def cosine_directions(normal, rings=400, sectors=800):
    """(D, 3) directions about a unit normal, each of the same cosine-weighted part."""
    radius = np.sqrt((np.arange(rings) + 0.5) / rings)
    turn = (np.arange(sectors) + 0.5) / sectors * 2 * np.pi
    radius, turn = (a.ravel() for a in np.meshgrid(radius, turn, indexing="ij"))
    normal = np.asarray(normal, float)
    across = np.cross(normal, [1.0, 0, 0] if abs(normal[0]) < 0.7 else [0, 1.0, 0])
    across /= np.linalg.norm(across)
    local = [radius * np.cos(turn), radius * np.sin(turn), np.sqrt(1 - radius**2)]
    return np.stack(local, axis=1) @ np.stack([across, np.cross(normal, across), normal])


def ambient(normal, free, radiance):
    """Free part, mean free direction (3,), and the part of the radiance that is free.

    free(directions) (D,) bool, radiance(directions) (D,)
    """
    directions = cosine_directions(normal)
    open_, light = free(directions), radiance(directions)
    bent = (directions * open_[:, None]).mean(axis=0)
    return open_.mean(), bent, (light * open_).sum() / light.sum()
