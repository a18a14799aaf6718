"""Surfaces made of normals and views, for tests of light."""

import numpy as np

from raysvc.shading.brushed import Brushed
from raysvc.shading.coat import Coat
from raysvc.shading.glass import Glass
from raysvc.shading.surface import Surface


def surface_of(normal, view, base=1.0, metallic=1.0, roughness=0.5, dielectric_f0=0.04):
    """Surface of N points; normal and view (N, 3), the rest scalars or what broadcasts."""
    normal = np.ascontiguousarray(normal, np.float32)
    count = len(normal)

    def filled(value, *shape):
        return np.ascontiguousarray(np.broadcast_to(np.asarray(value, np.float32), (count, *shape)))

    return Surface(
        position=filled(0, 3),
        geometric_normal=normal,
        normal=normal,
        to_viewer=filled(view, 3),
        base_colour=filled(base, 3),
        alpha=filled(1),
        metallic=filled(metallic),
        roughness=filled(roughness),
        dielectric_f0=filled(dielectric_f0),
        transmission=filled(0),
        emissive=filled(0, 3),
        occlusion=filled(1),
        unlit=np.zeros(count, bool),
        clearance=filled(0),
        coat=Coat.empty(0),
        glass=Glass.empty(0),
    )


def brushed(surface, strength, rng=None, tangent=None):
    """The same points, brushed: along one tangent, or along tangents at random."""
    normal = surface.normal.astype(float)
    towards = (
        random_directions(rng, surface.size) if tangent is None else np.asarray(tangent, float)
    )
    across = np.cross(normal, np.cross(towards, normal))
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    strength = np.broadcast_to(np.float32(strength), surface.size).copy()
    return surface._replace(brushed=Brushed(strength, across.astype(np.float32)))


def random_directions(rng, count):
    """(count, 3) unit, uniform."""
    directions = rng.normal(size=(count, 3))
    return directions / np.linalg.norm(directions, axis=1, keepdims=True)


def views_of(rng, normal, least=0.05):
    """Views (N, 3) whose N.V is uniform in least..1."""
    tangent = np.cross(normal, random_directions(rng, len(normal)))
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    cosine = rng.uniform(least, 1, (len(normal), 1))
    return cosine * normal + np.sqrt(1 - cosine**2) * tangent
