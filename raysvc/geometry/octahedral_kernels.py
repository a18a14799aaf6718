"""The sphere on a square: directions of an octahedron whose faces are folded out.

Engelhardt and Dachsbacher, Octahedron environment maps, VMV 2008. +Y is the middle of the square
and -Y its corners; no trigonometry, no poles, and no seam for images with a border of what the
square's edges meet.
"""

import math

from raysvc.jit import inlined


@inlined
def octahedral_place(x: float, y: float, z: float) -> tuple[float, float]:
    """Place (u, v) in 0..1 of a direction, which need not be unit but must not be zero."""
    scale = 1.0 / (abs(x) + abs(y) + abs(z))
    u, v = x * scale, z * scale
    if y < 0.0:
        folded = 1.0 - abs(v) if u >= 0.0 else abs(v) - 1.0
        v = 1.0 - abs(u) if v >= 0.0 else abs(u) - 1.0
        u = folded
    return 0.5 * u + 0.5, 0.5 * v + 0.5


@inlined
def octahedral_direction(u: float, v: float) -> tuple[float, float, float]:
    """Unit direction of a place; up to a square's width outside of it, that of what it meets."""
    a, b = 2.0 * u - 1.0, 2.0 * v - 1.0
    # Beyond an edge lies the square itself, turned half about the edge's middle
    if abs(a) > 1.0:
        a, b = (2.0 - a if a > 0.0 else -2.0 - a), -b
    if abs(b) > 1.0:
        a, b = -a, (2.0 - b if b > 0.0 else -2.0 - b)
    y = 1.0 - abs(a) - abs(b)
    if y < 0.0:
        folded = 1.0 - abs(b) if a >= 0.0 else abs(b) - 1.0
        b = 1.0 - abs(a) if b >= 0.0 else abs(a) - 1.0
        a = folded
    scale = 1.0 / math.sqrt(a * a + y * y + b * b)
    return a * scale, y * scale, b * scale
