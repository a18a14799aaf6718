"""What people put into a park. Pieces come as (iron, stone) where they are of both."""

import numpy as np

from raysvc.builtin.mesh import Mesh, merged
from raysvc.builtin.shapes import box, disc, frustum, lathe, sphere

WOOD = (0.30, 0.17, 0.08)
LIMESTONE = (0.72, 0.68, 0.60)
OPAL = (1.0, 0.97, 0.90)
SLAB = (0.125, 0.0625)
"""Middle of a slab in the paving of eight rows, away from the dark joints."""


def plinth(radius: float, height: float) -> Mesh:
    """Round step of limestone with a rounded rim, its foot at the origin."""
    turn = np.linspace(0.0, 0.5 * np.pi, 7)
    rim = 0.06
    corner = np.column_stack([radius - rim * (1 - np.cos(turn)), height - rim * (1 - np.sin(turn))])
    side = lathe(np.vstack([[radius, 0.0], corner]), [96] * 8).textured(4, 0.3)
    top = disc(radius - rim, 96).moved([0, height, 0]).textured_at(*SLAB)
    foot = frustum(1.25 * radius, 1.25 * radius, 0.16, 96).textured(4, 0.1)
    tread = lathe(np.array([[1.25 * radius, 0.16], [radius, 0.16]]), [96, 96]).textured(4, 0.15)
    return merged([side, top, foot, tread]).coloured(LIMESTONE)


def lamp_post() -> tuple[Mesh, Mesh]:
    """Post of iron, 3.3 m high, with a globe of opal glass, foot at the origin."""
    profile = np.array(
        [
            [0.17, 0.0], [0.17, 0.06], [0.13, 0.12], [0.10, 0.3], [0.075, 0.42], [0.085, 0.5],
            [0.05, 0.6], [0.042, 1.6], [0.036, 2.7], [0.06, 2.76], [0.06, 2.8], [0.036, 2.84],
            [0.10, 2.95], [0.13, 2.97],
        ]
    )  # fmt: skip
    post = lathe(profile, [24] * len(profile))
    cap = lathe(np.array([[0.14, 3.29], [0.07, 3.36], [0.015, 3.40], [0.0, 3.5]]), [20, 16, 10, 0])
    globe = sphere(0.2, 12).moved([0, 3.13, 0]).coloured(OPAL).textured_at(*SLAB)
    return merged([post, cap]), globe


def bench() -> tuple[Mesh, Mesh]:
    """Bench 1.7 m wide that faces +Z: legs and arms of iron, wooden slats."""
    legs, slats = [], []
    for side in (-0.72, 0.72):
        legs += [
            box(0.05, 0.42, 0.06).moved([side, 0, 0.2]),
            box(0.05, 0.85, 0.06).turned(-8, 0).moved([side, 0, -0.2]),
            box(0.05, 0.05, 0.5).moved([side, 0.39, 0.0]),
            box(0.05, 0.04, 0.46).moved([side, 0.62, 0.02]),
            box(0.05, 0.24, 0.05).moved([side, 0.40, 0.22]),
        ]
    for depth in (-0.17, -0.05, 0.07, 0.19):
        slats.append(box(1.7, 0.035, 0.1).moved([0, 0.44, depth]))
    for level in (0.55, 0.68, 0.81):
        slats.append(box(1.7, 0.1, 0.03).turned(-8, 0).moved([0, level, -0.2 - 0.14 * level]))
    return merged(legs), merged(slats).coloured(WOOD).textured_at(*SLAB)
