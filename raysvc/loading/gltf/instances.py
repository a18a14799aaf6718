"""Where every mesh stands: the visited nodes, multiplied by EXT_mesh_gpu_instancing."""

from dataclasses import dataclass

import numpy as np

from raysvc.errors import InvalidScene, LimitExceeded
from raysvc.loading.gltf.accessors import Accessors
from raysvc.loading.gltf.document import Document, item
from raysvc.loading.gltf.extensions import Instancing, extension
from raysvc.loading.gltf.nodes import Hierarchy, matrices_from_trs, unit_quaternions
from raysvc.types import Doubles, Longs

_EXTENSION = "EXT_mesh_gpu_instancing"
_WIDTHS = {"TRANSLATION": 3, "ROTATION": 4, "SCALE": 3}
_NEUTRAL = {"TRANSLATION": (0, 0, 0), "ROTATION": (0, 0, 0, 1), "SCALE": (1, 1, 1)}


@dataclass(frozen=True, slots=True, eq=False)
class Placement:
    """The instances of one mesh.

    Attributes
    ----------
    mesh
        index into the document's meshes
    nodes
        (N,) int64 node of each instance
    world
        (N, 4, 4) float64 world from mesh
    """

    mesh: int
    nodes: Longs
    world: Doubles


def read_placements(
    document: Document, hierarchy: Hierarchy, accessors: Accessors
) -> list[Placement]:
    """Return the instances of every mesh that is shown, by mesh."""
    gltf = document.gltf
    visits_of_mesh: dict[int, list[int]] = {}
    for visit, number in enumerate(hierarchy.nodes.tolist()):
        node = gltf.nodes[number]
        if node.skin is not None:
            document.journal.note(
                "skins are not supported: shown as if it had none", f"nodes[{number}]"
            )
        if node.mesh is not None:
            item(gltf.meshes, node.mesh, "meshes", f"nodes[{number}].mesh")
            visits_of_mesh.setdefault(node.mesh, []).append(visit)
    offsets = _Offsets(document, accessors)
    placements, total = [], 0
    for mesh, visits in sorted(visits_of_mesh.items()):
        placement = _multiplied(mesh, hierarchy, np.array(visits), offsets)
        total += len(placement.nodes)
        if total > document.limits.max_nodes:
            raise LimitExceeded(f"more than {document.limits.max_nodes:,} instances", "nodes")
        placements.append(placement)
    return placements


def _multiplied(mesh: int, hierarchy: Hierarchy, visits: Longs, offsets: "_Offsets") -> Placement:
    nodes, world = hierarchy.nodes[visits], hierarchy.world[visits]
    if not offsets.used:
        return Placement(mesh, nodes, world)
    counts, worlds, total = [], [], 0
    for number, placed in zip(nodes.tolist(), world, strict=True):
        local = offsets.of_node(number)
        worlds.append(placed @ local)
        counts.append(len(local))
        total += len(local)
        offsets.check_total(total, number)
    return Placement(mesh, np.repeat(nodes, counts), np.concatenate(worlds))


class _Offsets:
    """The instance transforms of nodes that have the extension."""

    def __init__(self, document: Document, accessors: Accessors) -> None:
        self._document, self._accessors = document, accessors
        self.used = any(_EXTENSION in (node.extensions or {}) for node in document.gltf.nodes)

    def check_total(self, total: int, number: int) -> None:
        limit = self._document.limits.max_nodes
        if total > limit:
            raise LimitExceeded(f"more than {limit:,} instances", f"nodes[{number}]")

    def of_node(self, number: int) -> Doubles:
        """(N, 4, 4) node from instance; a single identity where there is no extension."""
        path = f"nodes[{number}]"
        found = extension(Instancing, _EXTENSION, self._document.gltf.nodes[number], path)
        if found is None:
            return np.eye(4)[None]
        here = f"{path}.extensions.{_EXTENSION}.attributes"
        given: dict[str, Doubles] = {}
        for name, index in found.attributes.items():
            if name in _WIDTHS:
                self.check_total(self._accessors.count(index, f"{here}.{name}"), number)
                values = self._accessors.floats(index, f"{here}.{name}", (_WIDTHS[name],))
                if not np.isfinite(values).all():
                    raise InvalidScene("is not finite", f"{here}.{name}")
                given[name] = values.astype(np.float64)
            elif not name.startswith("_"):
                self._document.journal.note("is ignored", f"{here}.{name}")
        counts = {len(values) for values in given.values()}
        if len(counts) > 1:
            raise InvalidScene("its accessors differ in count", here)
        count = counts.pop() if counts else 1
        parts = [
            given.get(name, np.tile(np.array(_NEUTRAL[name], np.float64), (count, 1)))
            for name in _WIDTHS
        ]
        rotation, _, _ = unit_quaternions(parts[1])
        return matrices_from_trs(parts[0], rotation, parts[2])
