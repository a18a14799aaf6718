"""Text of an OBJ file made plain for trimesh, which takes some liberties with it.

trimesh counts relative indices from the end of the file instead of from the line that they are on,
takes index 0 for 1, drops lines that are indented or have comments, and forgets the names of
materials that it could not read. All that is settled here.
"""

import codecs
import re
from dataclasses import dataclass

from raysvc.errors import InvalidScene, LimitExceeded
from raysvc.limits import Limits

_MAX_REPORTED = 80
_ODD_FACE = re.compile(r"^f(?= )(?!(?: -?\d{1,10}(?:/(?:-?\d{1,10})?){0,2})+ ?$).*", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class ObjText:
    """An OBJ file whose materials are called m0, m1, ... in the order of `materials`."""

    text: str
    materials: tuple[str, ...]
    """Names that faces use."""
    libraries: tuple[str, ...]
    """Files that `mtllib` names."""
    ignored: tuple[str, ...]
    """Kinds of statements that make something visible, but not triangles."""
    has_uv: bool
    has_normals: bool


def read_obj_text(data: bytes, limits: Limits, name: str) -> ObjText:
    """Decode and tidy an OBJ file. Raises InvalidScene naming the line, LimitExceeded."""
    text = _tidy(decode_text(data, name))
    faces = text.count("\nf ")
    vertices = text.count("\nv ")
    if vertices > limits.max_vertices or faces > limits.max_triangles:
        raise LimitExceeded(f"{vertices:,} vertices and {faces:,} faces are too many", name)
    odd = _ODD_FACE.search(text)
    if odd is not None:
        raise InvalidScene(f"has a face that is not one: {_shown(odd[0])}", name)
    if re.search(r"^f(?= )[^\n]*?[ /]-", text, re.MULTILINE):
        text = _with_absolute_indices(text, name)
    zero = re.search(r"^f(?= )[^\n]*?[ /]0+(?=[ /\n])", text, re.MULTILINE)
    if zero is not None:
        raise InvalidScene(f"has an index 0 in {_shown(zero[0])}; OBJ counts from 1", name)
    short = re.search(r"^f(?: \S+){0,2} *$", text, re.MULTILINE)
    if short is not None:
        raise InvalidScene(f"has a face of fewer than three corners: {_shown(short[0])}", name)

    libraries = re.findall(r"^mtllib (.+)$", text, re.MULTILINE)
    numbers: dict[str, int] = {}

    def renamed(match: re.Match[str]) -> str:
        return f"usemtl m{numbers.setdefault(match[1].strip(), len(numbers))}"

    text = re.sub(r"^usemtl(.*)$", renamed, text, flags=re.MULTILINE)
    text = re.sub(r"^mtllib .*$", "", text, flags=re.MULTILINE)
    return ObjText(
        text=text,
        materials=tuple(numbers),
        libraries=tuple(library.strip() for library in libraries),
        ignored=tuple(
            what
            for key, what in (
                ("p", "points"),
                ("l", "lines"),
                ("curv", "curves"),
                ("surf", "surfaces"),
            )
            if f"\n{key} " in text
        ),
        has_uv="\nvt " in text,
        has_normals="\nvn " in text,
    )


def decode_text(data: bytes, name: str) -> str:
    """Decode text that is UTF-8, UTF-16 with a byte order mark, or else Latin-1."""
    for mark, encoding in (
        (codecs.BOM_UTF8, "utf-8-sig"),
        (codecs.BOM_UTF16_LE, "utf-16"),
        (codecs.BOM_UTF16_BE, "utf-16"),
    ):
        if data.startswith(mark):
            try:
                return data.decode(encoding)
            except UnicodeDecodeError:
                raise InvalidScene(f"is not the {encoding} text it claims to be", name) from None
    if b"\0" in data:
        raise InvalidScene("is binary, not text", name)
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def _tidy(text: str) -> str:
    """One statement a line, without comments, indentation and tabs; a line break at both ends."""
    text = "\n" + text.replace("\r\n", "\n").replace("\r", "\n") + "\n"
    if "\\\n" in text:
        text = text.replace("\\\n", " ")
    if "#" in text:
        text = re.sub(r"#[^\n]*", "", text)
    if "\t" in text:
        text = text.replace("\t", " ")
    if "\n " in text:
        text = re.sub(r"\n +", "\n", text)
    if "  " in text:
        text = re.sub(r"(?<! ) {2,}", " ", text)
    return text


def _with_absolute_indices(text: str, name: str) -> str:
    """Replace negative indices: -1 is the last vertex that was given before the line."""
    counts = {"v": 0, "vt": 0, "vn": 0}
    lines = text.split("\n")
    for number, line in enumerate(lines):
        key, _, rest = line.partition(" ")
        if key in counts:
            counts[key] += 1
        elif key == "f" and "-" in rest:
            last = tuple(counts.values())
            try:
                corners = [_absolute(corner, last) for corner in rest.split()]
            except ValueError:
                where = _shown(line)
                raise InvalidScene(f"has an index that is not there in {where}", name) from None
            lines[number] = "f " + " ".join(corners)
    return "\n".join(lines)


def _absolute(corner: str, last: tuple[int, ...]) -> str:
    """One `v/vt/vn` of a face; raises ValueError for what is before the first."""
    indices = []
    for index, count in zip(corner.split("/"), last, strict=False):
        absolute = index
        if index.startswith("-"):
            absolute = str(count + 1 + int(index))
            if int(absolute) < 1:
                raise ValueError(index)
        indices.append(absolute)
    return "/".join(indices)


def _shown(line: str) -> str:
    return repr(line.strip()[:_MAX_REPORTED])
