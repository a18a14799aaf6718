"""Paths of rays through mirrors and glass in double precision, and their central differences.

A path is a list of surfaces, each with what happens there. The same surfaces are met whatever the
ray, triangles as planes without edges, so that the end of a path is a smooth function of the pixel.
"""

from dataclasses import dataclass

import numpy as np


def unit(v):
    return np.asarray(v, float) / np.linalg.norm(v)


@dataclass(frozen=True)
class Sphere:
    centre: np.ndarray
    radius: float
    far: bool = False
    """Met where the ray leaves it."""

    def hit(self, origin, direction):
        """Distance, normal of the tangent plane, shading normal: outwards."""
        away = origin - self.centre
        b = away @ direction
        root = np.sqrt(b * b - (away @ away - self.radius**2))
        t = -b + root if self.far else -b - root
        normal = (origin + t * direction - self.centre) / self.radius
        return t, normal, normal


@dataclass(frozen=True)
class Triangle:
    corners: np.ndarray
    normals: np.ndarray

    def hit(self, origin, direction):
        """The shading normal is mixed from the corners' by the solution of a 3 x 3 system."""
        a, b, c = self.corners
        plane = np.cross(b - a, c - a)
        t = (a - origin) @ plane / (direction @ plane)
        point = origin + t * direction
        weights = np.linalg.lstsq(
            np.vstack([self.corners.T, np.ones(3)]), np.append(point, 1.0), rcond=None
        )[0]
        return t, unit(plane), unit(weights @ self.normals)


def reflect(direction, normal):
    return direction - 2 * (direction @ normal) * normal


def refract(direction, normal, eta):
    """Snell's law by angles: eta is the index before over that behind."""
    if direction @ normal > 0:
        normal = -normal
    across = direction - (direction @ normal) * normal
    sine = np.linalg.norm(across)
    if sine == 0:
        return direction
    inside = np.arcsin(eta * sine)
    return np.sin(inside) * across / sine - np.cos(inside) * normal


def follow(origin, direction, path):
    """Origin and direction of the ray after every surface of a path.

    path: pairs of a surface and what happens: "reflect", or ("refract", eta), or None at the end;
    perhaps with a vector (3,) by which the ray then starts off the surface.
    """
    rays = [(origin, direction)]
    for surface, event, *off in path:
        origin, direction = rays[-1]
        t, _, normal = surface.hit(origin, direction)
        origin = origin + t * direction + (off[0] if off else 0.0)
        if event == "reflect":
            direction = reflect(direction, normal)
        elif event is not None:
            direction = refract(direction, normal, event[1])
        rays.append((origin, direction))
    return rays


def central_difference(function, at, step):
    """Derivative of a function of one number whose value is an array; wrong by O(step^4)."""

    def across(h):
        return np.asarray(function(at + h)) - np.asarray(function(at - h))

    return (8 * across(step) - across(2 * step)) / (12 * step)
