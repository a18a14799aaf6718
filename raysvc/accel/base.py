"""The whole contract of an acceleration structure, on one page."""

from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np

from raysvc.accel.report import BuildReport, Counters, Query
from raysvc.errors import InvalidInput
from raysvc.geometry.triangle_kernels import hits_on_triangles
from raysvc.types import Bools, Floats, Ints


@dataclass(frozen=True, slots=True, eq=False)
class Triangles:
    """F triangles over V vertices: positions (V, 3) float32, indices (F, 3) int32, all in range."""

    positions: Floats
    indices: Ints


@dataclass(frozen=True, slots=True, eq=False)
class Rays:
    """R rays from `origins` along `directions`, up to `t_max` in units of |direction|.

    origins (R, 3), directions (R, 3), t_max (R,), all float32 and C-contiguous. A ray starts at
    t = 0: the caller moves origins off the surface that they lie on."""

    origins: Floats
    directions: Floats
    t_max: Floats

    def __post_init__(self) -> None:
        count = len(self.origins)
        for name, shape in (
            ("origins", (count, 3)),
            ("directions", (count, 3)),
            ("t_max", (count,)),
        ):
            array = getattr(self, name)
            if array.shape != shape or array.dtype != np.float32 or not array.flags.c_contiguous:
                raise InvalidInput(f"must be contiguous float32 of shape {shape}", field=name)

    def __len__(self) -> int:
        return len(self.origins)


class Hits(NamedTuple):
    """Nearest hits of R rays; a miss is t = inf, triangle = -1, barycentric = 0.

    t (R,) float32 in units of |direction|; triangle (R,) int32; barycentric (R, 2) float32, the
    weights of vertices 1 and 2.
    """

    t: Floats
    triangle: Ints
    barycentric: Floats


class Accelerator(Protocol):
    """Answers questions about one immutable set of triangles, from many threads at once.

    All structures but Embree agree to the bit: where several triangles are equally near, the one of
    the lowest number is the first.
    """

    report: BuildReport

    @property
    def state_bytes(self) -> int | None:
        """What the traversal of one ray keeps, apart from the ray; None where it cannot be seen."""

    @property
    def refits(self) -> bool:
        """Does `refitted` keep the tree and move its boxes, or build anew?"""

    def nearest_triangle(self, rays: Rays) -> Ints:
        """(R,) int32: the first triangle along each ray within 0..t_max, or -1."""

    def occluded(self, rays: Rays) -> Bools:
        """(R,) bool: is there any triangle along the ray within 0..t_max?"""

    def counted(self, rays: Rays, query: Query) -> Counters | None:
        """Ask again and say what it took; None where it cannot be seen."""

    def refitted(self, positions: Floats) -> "Accelerator":
        """Return a structure over the same triangles with vertices moved to positions (V, 3)."""


class Builder(Protocol):
    """Makes a structure of one kind with the parameters of that kind."""

    def __call__(self, triangles: Triangles, params: Any) -> Accelerator:
        """Build; `params` is an instance of the registry entry's parameter class."""


def hits_on(triangles: Triangles, triangle: Ints, rays: Rays) -> Hits:
    """Hits of rays whose triangle (R,) is known; t and barycentrics come from it alone."""
    t = np.empty(len(rays), np.float32)
    barycentric = np.empty((len(rays), 2), np.float32)
    hits_on_triangles(
        rays.origins,
        rays.directions,
        triangles.positions,
        triangles.indices,
        triangle,
        t,
        barycentric,
    )
    return Hits(t, triangle, barycentric)


def nearest(structure: Accelerator, triangles: Triangles, rays: Rays) -> Hits:
    """Nearest hits; the structure says only which triangle."""
    return hits_on(triangles, structure.nearest_triangle(rays), rays)
