"""The glTF document: JSON text checked and turned into pygltflib's classes."""

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np
import pygltflib

from raysvc.errors import InvalidScene, LimitExceeded, Unsupported
from raysvc.limits import Limits
from raysvc.loading.files import Files
from raysvc.loading.gltf.container import is_container, open_container
from raysvc.loading.gltf.extensions import check_required, note_unsupported
from raysvc.loading.gltf.journal import Journal
from raysvc.loading.gltf.schema import decode

Item = TypeVar("Item")

_STRING = re.compile(rb'"[^"\\]*+(?:\\.[^"\\]*+)*+"', re.DOTALL)
# Others are noted where they are read, and only if they are.
_NOTED_HERE = ("accessors", "buffers", "bufferViews", "cameras", "images", "samplers")
_VALUES_PER_NODE = 100
_BYTE_ORDER_MARK = b"\xef\xbb\xbf"


@dataclass(frozen=True, slots=True)
class Document:
    """A document with where its bytes come from; what is read is checked by whoever reads it."""

    gltf: pygltflib.GLTF2
    files: Files
    limits: Limits
    binary: bytes | None = None
    """The container's own buffer."""
    journal: Journal = field(default_factory=Journal)


def read_document(files: Files, limits: Limits) -> Document:
    """Read a .gltf or .glb; raises InvalidInput naming what is wrong."""
    journal = Journal()
    text, binary = files.read(files.main, field="main"), None
    if not text:
        raise InvalidScene("is empty", files.main)
    if is_container(text):
        text, binary = open_container(text, journal)
    if text.startswith(_BYTE_ORDER_MARK):
        journal.note("a byte order mark is skipped", "json")
        text = text[len(_BYTE_ORDER_MARK) :]
    tree = _parse(text, limits)
    _check_version(tree)
    nodes = tree.get("nodes")
    if isinstance(nodes, list) and len(nodes) > limits.max_nodes:
        raise LimitExceeded(f"{len(nodes):,}; the limit is {limits.max_nodes:,}", "nodes")
    gltf = decode(pygltflib.GLTF2, tree, "")
    check_required(gltf)
    note_unsupported(gltf, "document", journal)
    for name in _NOTED_HERE:
        for number, part in enumerate(getattr(gltf, name)):
            note_unsupported(part, f"{name}[{number}]", journal)
    return Document(gltf, files, limits, binary, journal)


def item(items: Sequence[Item], index: int, name: str, path: str) -> Item:
    """Return items[index], where `path` is who asks and `name` what the list is called."""
    if not 0 <= index < len(items):
        raise InvalidScene(f"refers to {name}[{index}]; there are {len(items)}", path)
    return items[index]


def _parse(text: bytes, limits: Limits) -> dict[str, object]:
    _check_shape(text, limits)
    try:
        tree = json.loads(text.decode("utf-8"))
    except UnicodeDecodeError as error:
        raise InvalidScene(f"is not UTF-8 at byte {error.start}", "json") from None
    except RecursionError:
        raise LimitExceeded("is nested too deeply", "json") from None
    except ValueError as error:
        raise InvalidScene(f"is not JSON: {str(error)[:200]}", "json") from None
    if not isinstance(tree, dict):
        raise InvalidScene("is not an object", "json")
    return tree


def _check_shape(text: bytes, limits: Limits) -> None:
    """Bound depth and number of values before a parser builds them."""
    bare = np.frombuffer(_STRING.sub(b"", text), np.uint8)
    opened = (bare == ord("{")) | (bare == ord("["))
    closed = (bare == ord("}")) | (bare == ord("]"))
    values = int(np.count_nonzero(opened)) + int(np.count_nonzero(bare == ord(",")))
    if values > _VALUES_PER_NODE * limits.max_nodes:
        raise LimitExceeded(f"holds {values:,} values", "json")
    steps = opened.astype(np.int8) - closed.astype(np.int8)
    steps = steps[steps != 0]
    if steps.size and int(np.cumsum(steps, dtype=np.int64).max()) > limits.max_json_depth:
        raise LimitExceeded(f"is nested deeper than {limits.max_json_depth}", "json")


def _check_version(tree: dict[str, object]) -> None:
    asset = decode(pygltflib.Asset, tree.get("asset", {}), "asset")
    if not isinstance(tree.get("asset"), dict) or "version" not in tree["asset"]:  # type: ignore[operator]
        raise InvalidScene("is missing", "asset.version")
    wanted = asset.minVersion or asset.version
    if wanted.split(".")[0] != "2" or (asset.minVersion and wanted != "2.0"):
        raise Unsupported(f"glTF {wanted[:20]}; only 2.0 is read", "asset.version")
