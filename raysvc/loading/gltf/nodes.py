"""The node hierarchy: where every visited node stands in the world (specification, section 3.5).

All nodes of one level are transformed at once. A node that several parents share is visited once
per path, up to the limit; cycles are refused.
"""

from dataclasses import dataclass

import numpy as np
import pygltflib

from raysvc.errors import InvalidScene, LimitExceeded
from raysvc.loading.gltf.document import Document, item
from raysvc.loading.gltf.extensions import note_unsupported
from raysvc.loading.gltf.journal import Journal
from raysvc.types import Doubles, Longs

_AFFINE_TOLERANCE = 1e-3
_UNIT_TOLERANCE = 1e-2


@dataclass(frozen=True, slots=True, eq=False)
class Hierarchy:
    """Nodes as they are visited, parents before children.

    Attributes
    ----------
    nodes
        (N,) int64 index of the node
    world
        (N, 4, 4) float64 world from node
    """

    nodes: Longs
    world: Doubles


def read_hierarchy(document: Document) -> Hierarchy:
    """Visit the default scene's nodes.

    Raises InvalidScene for a bad index, a cycle or a matrix that is not finite and affine, and
    LimitExceeded for too many paths or too deep a hierarchy.
    """
    nodes, limits = document.gltf.nodes, document.limits
    for number, node in enumerate(nodes):
        if node.extensions:
            note_unsupported(node, f"nodes[{number}]", document.journal)
    children, first_child = _children(nodes)
    _refuse_cycles(nodes, children)
    level = _roots(document, children)
    local = local_matrices(nodes, document.journal)
    world = local[level]
    levels, worlds, visited = [level], [world], len(level)
    while True:
        counts = first_child[level + 1] - first_child[level]
        total = int(counts.sum())
        if not total:
            break
        visited += total
        if visited > limits.max_nodes:
            raise LimitExceeded(
                f"the hierarchy visits more than {limits.max_nodes:,} nodes", "nodes"
            )
        if len(levels) >= limits.max_node_depth:
            raise LimitExceeded(
                f"deeper than {limits.max_node_depth:,} levels", f"nodes[{level[0]}].children"
            )
        parent = np.repeat(np.arange(len(level)), counts)
        within = np.arange(total) - np.repeat(np.cumsum(counts) - counts, counts)
        level = children[first_child[level][parent] + within]
        with np.errstate(over="ignore", invalid="ignore"):
            world = world[parent] @ local[level]
        _check_finite(world, level)
        levels.append(level)
        worlds.append(world)
    return Hierarchy(np.concatenate(levels), np.concatenate(worlds))


def local_matrices(nodes: list[pygltflib.Node], journal: Journal) -> Doubles:
    """Return (N, 4, 4) float64 parent from node, of `matrix` or translation, rotation, scale."""
    local = matrices_from_trs(
        np.array([node.translation or (0, 0, 0) for node in nodes], np.float64).reshape(-1, 3),
        _unit_rotations(nodes, journal),
        np.array([node.scale or (1, 1, 1) for node in nodes], np.float64).reshape(-1, 3),
    )
    for number, node in enumerate(nodes):
        if node.matrix is not None:
            here = f"nodes[{number}].matrix"
            if node.translation or node.rotation or node.scale:
                journal.note("is used instead of translation, rotation and scale", here)
            local[number] = _affine(np.array(node.matrix, np.float64).reshape(4, 4).T, here)
    return local


def matrices_from_trs(translation: Doubles, rotation: Doubles, scale: Doubles) -> Doubles:
    """Return translation * rotation * scale.

    Parameters
    ----------
    translation, rotation, scale
        (N, 3), (N, 4) unit quaternions x y z w, (N, 3) float64

    Returns
    -------
    (N, 4, 4) float64
    """
    x, y, z, w = np.moveaxis(rotation, -1, 0)
    matrices = np.zeros((len(rotation), 4, 4))
    matrices[:, 0, 0] = 1 - 2 * (y * y + z * z)
    matrices[:, 0, 1] = 2 * (x * y - z * w)
    matrices[:, 0, 2] = 2 * (x * z + y * w)
    matrices[:, 1, 0] = 2 * (x * y + z * w)
    matrices[:, 1, 1] = 1 - 2 * (x * x + z * z)
    matrices[:, 1, 2] = 2 * (y * z - x * w)
    matrices[:, 2, 0] = 2 * (x * z - y * w)
    matrices[:, 2, 1] = 2 * (y * z + x * w)
    matrices[:, 2, 2] = 1 - 2 * (x * x + y * y)
    matrices[:, :3, :3] *= scale[:, None, :]
    matrices[:, :3, 3] = translation
    matrices[:, 3, 3] = 1.0
    return matrices


def unit_quaternions(rotation: Doubles) -> tuple[Doubles, Longs, Longs]:
    """Return (N, 4) unit quaternions, which of them had no length, and which were not unit."""
    largest = np.abs(rotation).max(axis=1, initial=0.0, keepdims=True)
    scaled = rotation / np.where(largest > 0, largest, 1.0)
    length = np.sqrt((scaled**2).sum(axis=1, keepdims=True))
    zero = largest[:, 0] == 0
    unit = np.where(zero[:, None], (0.0, 0.0, 0.0, 1.0), scaled / np.where(length > 0, length, 1))
    off = np.abs(length[:, 0] * largest[:, 0] - 1.0) > _UNIT_TOLERANCE
    return unit, np.flatnonzero(zero), np.flatnonzero(off & ~zero)


def _unit_rotations(nodes: list[pygltflib.Node], journal: Journal) -> Doubles:
    given = np.array([node.rotation or (0, 0, 0, 1) for node in nodes], np.float64)
    unit, zero, off = unit_quaternions(given.reshape(-1, 4))
    for number in zero:
        journal.note("has no length and is read as no rotation", f"nodes[{number}].rotation")
    for number in off:
        journal.note("is not a unit quaternion and is made one", f"nodes[{number}].rotation")
    return unit


def _affine(matrix: Doubles, path: str) -> Doubles:
    if np.abs(matrix[3] - (0, 0, 0, 1)).max() > _AFFINE_TOLERANCE:
        raise InvalidScene("its last row is not 0 0 0 1", path)
    matrix[3] = (0, 0, 0, 1)
    return matrix


def _children(nodes: list[pygltflib.Node]) -> tuple[Longs, Longs]:
    """All children one after another, and where each node's begin; (N + 1,) entries."""
    for number, node in enumerate(nodes):
        for child in node.children:
            item(nodes, child, "nodes", f"nodes[{number}].children")
    flat = np.array([child for node in nodes for child in node.children], np.int64)
    counts = np.array([len(node.children) for node in nodes], np.int64)
    return flat, np.concatenate([np.zeros(1, np.int64), np.cumsum(counts)])


def _roots(document: Document, children: Longs) -> Longs:
    gltf, journal = document.gltf, document.journal
    if not gltf.scenes:
        if gltf.scene is not None:
            item(gltf.scenes, gltf.scene, "scenes", "scene")
        if gltf.nodes:
            journal.note("there are none; all root nodes are shown", "scenes")
        return np.setdiff1d(np.arange(len(gltf.nodes)), children)
    number = 0 if gltf.scene is None else gltf.scene
    scene = item(gltf.scenes, number, "scenes", "scene")
    if len(gltf.scenes) > 1:
        journal.note(f"only scenes[{number}] is shown", "scenes")
    here = f"scenes[{number}]"
    note_unsupported(scene, here, journal)
    for place, root in enumerate(scene.nodes):
        item(gltf.nodes, root, "nodes", f"{here}.nodes[{place}]")
    if len(scene.nodes) > document.limits.max_nodes:
        raise LimitExceeded("has too many nodes", f"{here}.nodes")
    return np.array(scene.nodes, np.int64)


def _refuse_cycles(nodes: list[pygltflib.Node], children: Longs) -> None:
    """Take nodes without parents away until none is left (Kahn 1962); a cycle stays."""
    waiting = np.bincount(children, minlength=len(nodes)).tolist()
    ready = [number for number, parents in enumerate(waiting) if parents == 0]
    for number in ready:
        for child in nodes[number].children:
            waiting[child] -= 1
            if waiting[child] == 0:
                ready.append(child)
    if len(ready) == len(nodes):
        return
    # Whoever waits has a parent that waits too, so going up ends up on a cycle.
    parent = {
        child: number
        for number, node in enumerate(nodes)
        if waiting[number] > 0
        for child in node.children
    }
    seen: set[int] = set()
    at = next(number for number, parents in enumerate(waiting) if parents > 0)
    while at not in seen:
        seen.add(at)
        at = parent[at]
    raise InvalidScene("the node is its own ancestor", f"nodes[{at}].children")


def _check_finite(world: Doubles, level: Longs) -> None:
    finite = np.isfinite(world).all(axis=(1, 2))
    if not finite.all():
        number = level[int(np.argmin(finite))]
        raise InvalidScene("its world transform is not finite", f"nodes[{number}]")
