"""Vectors of three numbers inside kernels, as tuples: they live in registers."""

import math

import numpy as np

from raysvc.jit import inlined
from raysvc.types import Doubles, Floats

Vec3 = tuple[float, float, float]


@inlined
def dot(a: Vec3, b: Vec3) -> float:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def cross(a: Vec3, b: Vec3) -> Vec3:
    """Vector product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@inlined
def scaled(a: Vec3, k: float) -> Vec3:
    """Vector times number."""
    return (a[0] * k, a[1] * k, a[2] * k)


@inlined
def plus(a: Vec3, b: Vec3, k: float) -> Vec3:
    """a + k b."""
    return (a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2])


@inlined
def unit_or(a: Vec3, other: Vec3) -> Vec3:
    """A vector scaled to length 1, or `other` where it is (nearly) zero."""
    length = math.sqrt(dot(a, a))
    return scaled(a, 1.0 / length) if length > 1e-20 else other


@inlined
def row3(array: Floats | Doubles, row: int) -> Vec3:
    """Row of an (N, 3) array as doubles; Numba's float() would leave it single."""
    return (np.float64(array[row, 0]), np.float64(array[row, 1]), np.float64(array[row, 2]))
