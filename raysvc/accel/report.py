"""What a structure cost to build, and what asking it costs: the figures that structures are
compared by.
"""

import time
from dataclasses import dataclass, replace
from typing import Literal

from raysvc.types import Ints, Longs

Query = Literal["nearest", "occluded"]


@dataclass(frozen=True, slots=True)
class BuildReport:
    """What building, or refitting, cost; a number that cannot be seen from outside is None.

    Depths are of leaves, the root's being 0. `sah_cost` is (sum over inner nodes of A + sum over
    leaves of A * triangles) / A of the root, A being a box's area: one step and one triangle cost
    the same. Precomputed corners of triangles are not counted as tree, whichever structure keeps
    them.
    """

    triangles: int
    build_ms: float
    nodes: int | None = None
    leaves: int | None = None
    empty_leaves: int | None = None
    max_depth: int | None = None
    mean_depth: float | None = None
    triangle_references: int | None = None
    mean_triangles_per_leaf: float | None = None
    mean_triangles_per_nonempty_leaf: float | None = None
    duplication: float | None = None
    node_bytes: int | None = None
    index_bytes: int | None = None
    tree_mib: float | None = None
    sah_cost: float | None = None
    epo: float | None = None
    """See `raysvc.accel.quality`, which measures this and `lcv` when asked to."""
    lcv: float | None = None

    @property
    def seconds(self) -> float:
        """Time that building took."""
        return self.build_ms / 1000.0

    def since(self, start: float) -> "BuildReport":
        """Return the report of work that began at `start`, by time.perf_counter."""
        return replace(self, build_ms=1000.0 * (time.perf_counter() - start))


@dataclass(frozen=True, slots=True, eq=False)
class Counters:
    """What R rays did, each (R,) int32 and `bytes_touched` (R,) int64; `triangle` is what they
    found.

    A `node_step` is a node fetched; what is tested there is each structure's own convention, which
    its class states. A stack write is a push. `bytes_touched` is a model: nodes and triangles
    fetched, each at its size in memory. A triangle that a mailbox spares is not a test.
    """

    triangle: Ints
    node_steps: Ints
    box_tests: Ints
    plane_tests: Ints
    triangle_tests: Ints
    stack_writes: Ints
    max_stack_depth: Ints
    leaves: Ints
    bytes_touched: Longs
