"""What the talk of 2009 ("Shiny, Blurry Things") says of its structures, as data.

It measured a torus in a park of four materials with four trees on a Radeon HD 4870. Our scene
`builtin:torus_park` has the same numbers of triangles; the meshes themselves are not public.
"""

from dataclasses import dataclass
from typing import Final

from raysvc.compare.settings import Trees

SCENE: Final = "builtin:torus_park"


@dataclass(frozen=True, slots=True)
class TalkStructure:
    """A row of the talk's two tables; its tree table has no row for the stackless BVH."""

    name: str
    """Of the structure in our registry."""
    nodes: int | None
    max_depth: int | None
    mean_depth: float | None
    triangle_references: int | None
    mean_triangles_per_leaf: float | None
    tree_mib: float | None
    time_s: float
    traversals: float
    writes_per_traversal: float
    alu_operations: float
    alu_percent: float
    tex_percent: float
    registers: int


@dataclass(frozen=True, slots=True)
class Talk:
    """The talk's rows, and what to know when they stand beside ours."""

    source: str
    structures: tuple[TalkStructure, ...]
    notes: tuple[str, ...]


# fmt: off
TALK: Final = Talk(
    source="Shiny, Blurry Things (course talk, 2009); DirectX 10.1, Radeon HD 4870",
    structures=(
        TalkStructure(
            "bvh", 113_994, 21, 15.4, 288_852, 5.07, 3.48,
            131.68, 2.15418e11, 0.112, 7.41555e12, 46.92, 30.57, 14,
        ),
        TalkStructure(
            "kd", 171_048, 27, 19.8, 834_996, 9.76, 4.49,
            184.77, 3.02104e11, 0.168, 7.79515e12, 35.15, 22.35, 18,
        ),
        TalkStructure(
            "bvh_stackless", None, None, None, None, None, None,
            198.73, 3.7035e11, 0.0, 1.56182e13, 65.49, 37.44, 15,
        ),
        TalkStructure(
            "bih", 140_944, 27, 19.1, 288_852, 4.88, 2.15,
            210.26, 3.28972e11, 0.165, 1.02991e13, 40.81, 15.21, 11,
        ),
    ),
    notes=(
        "The number of rays behind the talk's times and traversals is not stated: the figure on "
        "the slide would mean 189 visits of the whole tree for every ray. Compare ratios between "
        "structures, not rays per second.",
        "A traversal of the talk is a node fetched. Ours is the same, but a step of `bvh` tests "
        "the boxes of both children while one of `bvh_stackless` tests its own; `steps` says which "
        "is which, and this alone is a factor of almost two between them.",
        "Triangles per leaf of the BIH are over leaves that are not empty; about 16 % of the "
        "talk's BIH leaves are empty.",
        "The talk's tree sizes count 32 bytes per BVH node and 16 per BIH node and no index list, "
        "but 8 bytes per kd node and 4 per triangle reference; ours are node_bytes + index_bytes "
        "for all.",
        "The talk ran on a GPU whose stack is memory; on a CPU the stack stays in the first-level "
        "cache, so that doing without it saves less.",
        "The triangle counts of the scene are the talk's, the shapes are not: its meshes are not "
        "public.",
    ),
)
# fmt: on


def talk_beside(source: str, trees: tuple[Trees, ...]) -> Talk | None:
    """The talk's figures where they belong: its scene, with one tree per material."""
    return TALK if source == SCENE and "per_material" in trees else None
