"""Light that arrives from all around: from the environment where it is free, from what hides it.

Rays from a point, dense where the cosine is great, say in which directions it is hidden. Each looks
the environment up in its own direction, so that a point that is only open towards a dark side is
dark. What comes of that is a ratio: the part of the environment's light that gets through. It
multiplies the environment's lobe over the open point, which is exact and has no noise (Heitz, Hill
and McGuire 2018, "Combining Analytic Direct Illumination and Stochastic Shadows"). So it is 1 where
nothing hides anything, and the free part of the hemisphere where the environment is the same
everywhere.
"""

from typing import NamedTuple

import numpy as np

from raysvc.lighting.ambient_kernels import gather_ambient
from raysvc.lighting.soft_map_kernels import SoftMap
from raysvc.types import Floats, Ints


class Ambient(NamedTuple):
    """What arrives from all around at N points, float32, on the mean of many directions."""

    visible: Floats
    """(N,) cosine-weighted part of the hemisphere that is free."""
    hidden: Floats
    """(N, 3) mean of the hidden directions, 0 for free ones."""
    sky: Floats
    """(N, 3) part of the environment's light that is not hidden, by colour."""
    bounced: Floats
    """(N, 3) radiance of what hides it, averaged over the whole hemisphere."""

    @staticmethod
    def open(count: int) -> "Ambient":
        """Points that nothing hides."""
        return Ambient(
            np.ones(count, np.float32),
            np.zeros((count, 3), np.float32),
            np.ones((count, 3), np.float32),
            np.zeros((count, 3), np.float32),
        )

    @staticmethod
    def of_columns(columns: Floats) -> "Ambient":
        """Take (N, 10) apart."""
        return Ambient(columns[:, 0], columns[:, 1:4], columns[:, 4:7], columns[:, 7:10])

    def bent_normal(self, normal: Floats) -> Floats:
        """(N, 3) unit mean of the free directions about normals (N, 3), 0 where none is free.

        The mean of all is two thirds of the normal (Landis 2002, "Production-Ready Global
        Illumination", for the name and the use).
        """
        free = np.float32(2.0 / 3.0) * normal - self.hidden
        length = np.sqrt(np.einsum("nk,nk->n", free, free))
        length[self.visible == 0] = np.inf
        bent: Floats = free / np.maximum(length, np.float32(1e-12))[:, None]
        return bent

    def columns(self) -> Floats:
        """Return all as (N, 10)."""
        return np.concatenate([self.visible[:, None], self.hidden, self.sky, self.bounced], axis=1)


def mean_of_rays(
    soft: SoftMap, directions: Floats, through: Floats, patch: Ints, radiance: Floats
) -> Ambient:
    """Take the mean over the rays of each of N points.

    Parameters
    ----------
    soft
        the environment, softened to the solid angle that a ray stands for
    directions
        (N, K, 3) unit, in proportion to the cosine
    through
        (N, K) part of the environment's light that comes through
    patch
        (N, K) what hides the rest, or -1 for something dark
    radiance
        (P, 3) of patches
    """
    count = len(directions)
    columns = np.empty((count, 10), np.float32)
    gather_ambient(soft, directions, through, patch, radiance, columns)
    return Ambient.of_columns(columns)
