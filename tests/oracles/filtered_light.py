"""Lobes and cosines over all texels of a lat-long map, one direction after the other."""

import numpy as np

from tests.oracles.lobe import map_directions


def filtered(radiance, directions, roughness):
    """Mean (N, 3) of a map over D(h) N.L around directions (N, 3) that are normal and view."""
    light, angles = map_directions(*radiance.shape[:2])
    alpha2 = roughness**4
    means = []
    for normal in directions:
        half = light + normal
        half /= np.linalg.norm(half, axis=1, keepdims=True) + 1e-30
        sine2 = (np.cross(normal, half) ** 2).sum(1)
        density = alpha2 / (np.pi * (sine2 * (1 - alpha2) + alpha2) ** 2)
        weight = density * np.maximum(light @ normal, 0) * angles
        means.append(weight @ radiance.reshape(-1, 3) / weight.sum())
    return np.array(means)


def irradiance(radiance, directions):
    """Irradiance (N, 3) of surfaces that face directions (N, 3)."""
    light, angles = map_directions(*radiance.shape[:2])
    facing = np.maximum(directions @ light.T, 0) * angles
    return facing @ radiance.reshape(-1, 3).astype(float)
