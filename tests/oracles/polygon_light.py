"""A glowing polygon, in closed form and by brute force."""

import numpy as np

from tests.oracles.brdf import gltf_lobes


def irradiance(point, normal, corners):
    """Of a polygon of radiance 1 that is all above the horizon: Lambert 1760."""
    towards = np.asarray(corners, float) - np.asarray(point, float)
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    total = np.zeros(3)
    for a, b in zip(towards, np.roll(towards, -1, axis=0), strict=True):
        across = np.cross(a, b)
        total += np.arccos(np.clip(a @ b, -1, 1)) * across / np.linalg.norm(across)
    return abs(0.5 * total @ np.asarray(normal, float))


def reflected(point, normal, view, corner, edges, steps=200, **material):
    """Diffuse and specular radiance (3,) of a parallelogram of radiance 1 from a grid of places."""
    u, v = (a.ravel() for a in np.meshgrid(*[(np.arange(steps) + 0.5) / steps] * 2))
    places = np.asarray(corner) + u[:, None] * edges[0] + v[:, None] * edges[1]
    away = places - point
    distance2 = (away**2).sum(axis=1)
    light = away / np.sqrt(distance2)[:, None]
    across = np.cross(*edges)
    angle = np.abs(light @ across) / distance2 / steps**2
    diffuse, specular = gltf_lobes(
        np.asarray(normal, float), np.asarray(view, float), light, **material
    )
    weight = (angle * np.maximum(light @ normal, 0))[:, None]
    return (diffuse * weight).sum(axis=0), (specular * weight).sum(axis=0)
