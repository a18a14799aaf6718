"""A glTF accessor read element by element, as slowly and plainly as the specification says it."""

import struct

FORMATS = {5120: "b", 5121: "B", 5122: "h", 5123: "H", 5125: "I", 5126: "f"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
LARGEST = {5120: 127, 5121: 255, 5122: 32767, 5123: 65535}


def read_accessor(document: dict, index: int, buffers: list[bytes]) -> list[list[float]]:
    accessor = document["accessors"][index]
    width, kind = WIDTHS[accessor["type"]], accessor["componentType"]
    elements = [[0] * width for _ in range(accessor["count"])]
    if "bufferView" in accessor:
        for number in range(accessor["count"]):
            elements[number] = _element(document, accessor, number, kind, width, buffers)
    if "sparse" in accessor:
        sparse = accessor["sparse"]
        for number in range(sparse["count"]):
            (where,) = _element(
                document, sparse["indices"], number, sparse["indices"]["componentType"], 1, buffers
            )
            elements[where] = _element(document, sparse["values"], number, kind, width, buffers)
    if accessor.get("normalized"):
        return [[max(value / LARGEST[kind], -1.0) for value in each] for each in elements]
    return elements


def _element(document, holder, number, kind, width, buffers) -> list:
    view = document["bufferViews"][holder["bufferView"]]
    code = "<" + FORMATS[kind] * width
    stride = view.get("byteStride", struct.calcsize(code))
    at = view.get("byteOffset", 0) + holder.get("byteOffset", 0) + number * stride
    return list(struct.unpack_from(code, buffers[view["buffer"]], at))
