"""What comes of a comparison, with the names that files and answers use.

A number that cannot be seen is None: Embree shows neither its nodes nor its steps.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Final

from raysvc.accel.report import Query
from raysvc.compare.heat_map import HeatMap
from raysvc.compare.ray_sets import RayKind
from raysvc.compare.settings import Trees
from raysvc.compare.talk_2009 import Talk


@dataclass(frozen=True, slots=True)
class BuildFigures:
    """What building cost, and the tree that came of it; see `raysvc.accel.report.BuildReport`."""

    nodes: int | None
    leaves: int | None
    empty_leaves: int | None
    max_depth: int | None
    mean_depth: float | None
    triangle_references: int | None
    mean_triangles_per_leaf: float | None
    mean_triangles_per_nonempty_leaf: float | None
    duplication: float | None
    node_bytes: int | None
    index_bytes: int | None
    tree_mib: float | None
    sah_cost: float | None
    epo: float | None
    """End-point overlap, of a single tree; see `raysvc.accel.quality`."""
    lcv: float | None
    """Leaf count variability, over 16,384 random rays whatever the rays of the comparison."""
    build_ms: float


@dataclass(frozen=True, slots=True)
class TraversalFigures:
    """What asking cost, all rays together; what a node step is, `STEPS` says for each structure."""

    node_steps_per_ray: float | None
    box_tests_per_ray: float | None
    plane_tests_per_ray: float | None
    triangle_tests_per_ray: float | None
    stack_writes_per_step: float | None
    max_stack_depth: int | None
    bytes_per_ray: float | None
    """Nodes and triangles fetched, each at its size in memory."""
    lane_utilisation: float | None
    """None where there are no lanes."""
    state_bytes: int | None
    mrays_per_s_one_thread: float
    mrays_per_s_all_threads: float
    iqr_one_thread: float
    """Between the quartiles of the rounds, in Mrays/s."""
    hits: int
    hit_checksum: float
    """Sum over rays that hit of t, in diagonals of the bounds (1 for `occluded`), times a weight by
    the ray's number, to four decimals: structures that answer alike agree in it."""


@dataclass(frozen=True, slots=True)
class StructureFigures:
    """One structure with one kind of trees."""

    name: str
    trees: Trees
    build: BuildFigures
    traversal: TraversalFigures


@dataclass(frozen=True, slots=True)
class RayFigures:
    """Which rays were asked."""

    kind: RayKind
    count: int
    seed: int


@dataclass(frozen=True, slots=True)
class TrianglePoint:
    """A structure over some of the scene's triangles."""

    name: str
    triangles: int
    build_ms: float
    mrays_per_s_one_thread: float


@dataclass(frozen=True, slots=True)
class ThreadPoint:
    """A structure asked by so many threads."""

    name: str
    threads: int
    mrays_per_s: float


@dataclass(frozen=True, slots=True)
class Scaling:
    """How structures fare with fewer triangles and with fewer threads."""

    triangles: tuple[TrianglePoint, ...]
    threads: tuple[ThreadPoint, ...]


STEPS: Final[Mapping[str, str]] = {
    "brute": "no nodes: every triangle is tested",
    "bvh": "a step fetches an inner node and tests the boxes of both children",
    "bvh_stackless": "a step fetches a node and tests its own box",
    "kd": "a step fetches a node; an inner one is one plane test",
    "bih": "a step fetches a node; an inner one is two plane tests, or clips its cell by two",
    "embree": "not seen from outside",
}
"""What a node step is, by the registry's names."""


@dataclass(frozen=True, slots=True)
class Comparison:
    """Everything that was measured."""

    scene: str
    triangles: int
    materials: int
    rays: RayFigures
    query: Query
    threads: int
    """What `all_threads` means."""
    rounds: int
    structures: tuple[StructureFigures, ...]
    sampled: Mapping[str, int]
    """`epo_triangles`, `lcv_rays`: from how many `epo` and `lcv` come; all triangles are exact."""
    scaling: Scaling | None
    talk_2009: Talk | None
    machine: Mapping[str, Any]
    seconds: float
    renderer_version: str
    heat_maps: Mapping[str, HeatMap]
    """By name and trees of a structure that can be looked into; not part of `to_dict`."""

    def to_dict(self) -> dict[str, Any]:
        """Return plain lists, numbers and strings, ready for JSON."""
        return {
            "scene": self.scene,
            "triangles": self.triangles,
            "materials": self.materials,
            "rays": asdict(self.rays),
            "query": self.query,
            "threads": self.threads,
            "rounds": self.rounds,
            "structures": [asdict(structure) for structure in self.structures],
            "sampled": dict(self.sampled),
            "steps": {
                name: text
                for name, text in STEPS.items()
                if any(s.name.partition(":")[0] == name for s in self.structures)
            },
            "scaling": asdict(self.scaling) if self.scaling is not None else None,
            "talk_2009": asdict(self.talk_2009) if self.talk_2009 is not None else None,
            "machine": dict(self.machine),
            "seconds": self.seconds,
            "renderer_version": self.renderer_version,
        }
