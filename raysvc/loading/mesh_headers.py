"""What mesh files claim to hold, checked against their length before anything is allocated."""

import re
from dataclasses import dataclass, field

from raysvc.errors import InvalidScene, LimitExceeded, Unsupported
from raysvc.limits import Limits

_SIZES = {
    "char": 1, "uchar": 1, "int8": 1, "uint8": 1,
    "short": 2, "ushort": 2, "int16": 2, "uint16": 2, "float16": 2,
    "int": 4, "uint": 4, "int32": 4, "uint32": 4, "float": 4, "float32": 4,
    "int64": 8, "uint64": 8, "double": 8, "float64": 8,
}  # fmt: skip
_MAX_HEADER_BYTES = 1 << 16
_MAX_PROPERTIES = 256


@dataclass(slots=True)
class PlyElement:
    """One `element` of a PLY header."""

    name: str
    count: int
    scalars: dict[str, str] = field(default_factory=dict)
    """Type of each property that is not a list."""
    lists: list[str] = field(default_factory=list)
    bytes_at_least: int = 0
    """Of one binary row; lists are counted as empty."""


@dataclass(frozen=True, slots=True)
class PlyHeader:
    """What a PLY file says of itself."""

    elements: dict[str, PlyElement]
    texture_file: str | None
    """From `comment TextureFile NAME`, which MeshLab writes."""


def read_ply_header(data: bytes, limits: Limits, name: str) -> PlyHeader:
    """Read the header and check its counts. Raises InvalidScene, Unsupported, LimitExceeded."""
    end = re.search(rb"^end_header\r?\n?", data[:_MAX_HEADER_BYTES], re.MULTILINE)
    if not re.match(rb"ply\s", data) or end is None:
        raise InvalidScene("has no complete PLY header", name)
    lines = data[: end.start()].decode("utf-8", "replace").splitlines()[1:]
    is_ascii = any(line.split()[:2] == ["format", "ascii"] for line in lines)
    elements: dict[str, PlyElement] = {}
    texture_file = None
    for line in lines:
        words = line.split()
        if line.lower().startswith("comment texturefile "):
            texture_file = line[len("comment texturefile ") :].strip()
        elif words[:1] == ["element"]:
            if len(words) != 3 or not words[2].isdecimal() or words[1] in elements:
                raise InvalidScene(f"has a PLY header with {line[:80]!r}", name)
            elements[words[1]] = PlyElement(words[1], int(words[2]))
        elif words[:1] == ["property"]:
            _add_property(elements, words, name)
    _check_ply_counts(elements, len(data) - end.end(), is_ascii, name)
    if "tristrips" in elements and not _count(elements, "face"):
        raise Unsupported("holds triangle strips (tristrips); write it with faces", name)
    _check_limits(_count(elements, "vertex"), _count(elements, "face"), limits, name)
    return PlyHeader(elements, texture_file)


def check_stl(data: bytes, limits: Limits, name: str) -> None:
    """Check the count of triangles of a binary STL file, and that ASCII is what it seems."""
    if len(data) >= 84:
        count = int.from_bytes(data[80:84], "little")
        if len(data) == 84 + 50 * count:
            _check_limits(3 * count, count, limits, name)
            return
    if not re.match(rb"\s*solid", data[:256], re.IGNORECASE) or b"\0" in data:
        raise InvalidScene("is neither ASCII STL nor as long as its count of triangles says", name)
    _check_limits(data.lower().count(b"vertex"), data.lower().count(b"facet") // 2, limits, name)


def check_off(data: bytes, limits: Limits, name: str) -> int:
    """Check the counts of an OFF file, and return how many faces it says it has."""
    text = re.sub(rb"#[^\n]*", b"", data[:_MAX_HEADER_BYTES])
    head = re.match(rb"\s*C?OFF\s+(\d+)\s+(\d+)", text)
    if head is None:
        raise InvalidScene("does not begin as an ASCII OFF file does", name)
    # A vertex takes at least "0 0 0" and a line break, a face "0" and a line break.
    if max(len(head[1]), len(head[2])) > 18 or 6 * int(head[1]) + 2 * int(head[2]) > len(data):
        counts = f"{head[1].decode()[:20]} vertices and {head[2].decode()[:20]} faces"
        raise InvalidScene(f"says {counts}, more than its {len(data):,} bytes can hold", name)
    _check_limits(int(head[1]), int(head[2]), limits, name)
    return int(head[2])


def _add_property(elements: dict[str, PlyElement], words: list[str], name: str) -> None:
    known = all(word in _SIZES for word in (words[2:4] if words[1:2] == ["list"] else words[1:2]))
    if not elements or not known or len(words) != (5 if words[1:2] == ["list"] else 3):
        raise InvalidScene(f"has a PLY header with {' '.join(words)[:80]!r}", name)
    element = next(reversed(elements.values()))
    if words[1] == "list":
        element.lists.append(words[4])
        element.bytes_at_least += _SIZES[words[2]]
    else:
        element.scalars[words[2]] = words[1]
        element.bytes_at_least += _SIZES[words[1]]
    if len(element.scalars) + len(element.lists) > _MAX_PROPERTIES:
        raise InvalidScene(f"has more than {_MAX_PROPERTIES} properties in an element", name)


def _check_ply_counts(
    elements: dict[str, PlyElement], remaining: int, is_ascii: bool, name: str
) -> None:
    """Refuse counts that the rest of the file is too short for."""
    for element in elements.values():
        values = len(element.scalars) + len(element.lists)
        # A number in text takes a digit and what separates it from the next.
        row_bytes = max(2 * values - 1 if is_ascii else element.bytes_at_least, 1)
        if element.count * row_bytes > remaining + 1:
            raise InvalidScene(
                f"says {element.count:,} times {element.name}, more than its bytes can hold", name
            )


def _count(elements: dict[str, PlyElement], element: str) -> int:
    return elements[element].count if element in elements else 0


def _check_limits(vertices: int, triangles: int, limits: Limits, name: str) -> None:
    if vertices > limits.max_vertices:
        raise LimitExceeded(f"{vertices:,} vertices; the limit is {limits.max_vertices:,}", name)
    if triangles > limits.max_triangles:
        raise LimitExceeded(f"{triangles:,} faces; the limit is {limits.max_triangles:,}", name)
