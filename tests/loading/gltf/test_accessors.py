"""Accessors against a decoder that reads one element after another."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from raysvc.errors import InvalidInput, InvalidScene, LimitExceeded
from raysvc.limits import DEFAULT_LIMITS
from raysvc.loading.files import Files
from raysvc.loading.gltf.accessors import Accessors
from raysvc.loading.gltf.buffers import Buffers
from raysvc.loading.gltf.document import Document, read_document
from tests.loading.gltf.building import COMPONENTS, TYPES, Builder
from tests.oracles.gltf_accessor import read_accessor


def opened(builder: Builder) -> tuple[Accessors, Document]:
    files = Files.from_memory({"scene.gltf": builder.text()})
    document = read_document(files, DEFAULT_LIMITS)
    return Accessors(document, Buffers(document)), document


def random_bytes(rng, kind: str, shape) -> np.ndarray:
    if kind == "f":
        return rng.normal(size=shape).astype("f")
    limits = np.iinfo(kind)
    return rng.integers(limits.min, limits.max, shape, kind, endpoint=True)


@settings(max_examples=120, deadline=None)
@given(
    kind=st.sampled_from("bBhHf"),
    width=st.integers(1, 4),
    count=st.integers(1, 9),
    stride=st.sampled_from([None, 16, 20, 24, 64]),
    offset=st.sampled_from([0, 4, 8]),
    normalised=st.booleans(),
    sparse=st.sampled_from([None, "B", "H", "I"]),
    backed=st.booleans(),
    seed=st.integers(0, 99),
)
def test_every_layout_reads_as_the_specification_says(
    kind, width, count, stride, offset, normalised, sparse, backed, seed
):
    rng = np.random.default_rng(seed)
    builder = Builder()
    builder.view(bytes(8))
    size = np.dtype(kind).itemsize * width
    data = random_bytes(
        rng, kind, (offset + count * (stride or size)) // np.dtype(kind).itemsize + 9
    )
    view = builder.view(data.tobytes(), **({"byteStride": stride} if stride else {}))
    accessor = {"componentType": COMPONENTS[kind], "count": count, "type": TYPES[width]}
    if backed:
        accessor |= {"bufferView": view, "byteOffset": offset}
    if normalised and kind != "f":
        accessor["normalized"] = True
    if sparse:
        chosen = np.sort(rng.choice(count, rng.integers(1, count + 1), replace=False))
        accessor["sparse"] = {
            "count": len(chosen),
            "indices": {
                "bufferView": builder.view(b"pad." + chosen.astype(sparse).tobytes()),
                "byteOffset": 4,
                "componentType": COMPONENTS[sparse],
            },
            "values": {
                "bufferView": builder.view(random_bytes(rng, kind, (len(chosen), width)).tobytes())
            },
        }
    index = builder.add("accessors", accessor)
    accessors, _ = opened(builder)
    expected = read_accessor(builder.tree, index, [builder.data])
    read = accessors.floats(index, "here", (width,))
    assert read.dtype == np.float32
    np.testing.assert_array_equal(read, np.array(expected, np.float32))


@pytest.mark.parametrize("kind", "BHI")
def test_indices_of_all_three_widths_are_read(kind):
    builder = Builder()
    index = builder.accessor(np.array([0, 200, 3], kind))
    accessors, _ = opened(builder)
    assert accessors.indices(index, "here").tolist() == [0, 200, 3]


@pytest.mark.parametrize(("kind", "largest"), [("b", 127), ("B", 255), ("h", 32767), ("H", 65535)])
def test_normalised_integers_reach_exactly_one(kind, largest):
    builder = Builder()
    lowest = np.iinfo(kind).min
    index = builder.accessor(np.array([0, largest, lowest], kind), normalized=True)
    accessors, _ = opened(builder)
    read = accessors.floats(index, "here", (1,))[:, 0].tolist()
    assert read == [0.0, 1.0, -1.0 if lowest else 0.0]


def test_a_misaligned_accessor_is_read_with_a_warning():
    builder = Builder()
    view = builder.view(b"x" + np.array([1, 2, 3], "f").tobytes())
    layout = {"componentType": 5126, "count": 3, "type": "SCALAR", "byteOffset": 1}
    index = builder.add("accessors", {"bufferView": view, **layout})
    accessors, document = opened(builder)
    assert accessors.floats(index, "here", (1,))[:, 0].tolist() == [1, 2, 3]
    assert document.journal.warnings() == ("accessors[0]: is not aligned to its components",)


def faulty(**changes):
    """An accessor of four floats, VEC2, with some of its properties changed."""
    builder = Builder()
    builder.accessor(np.zeros((4, 2), "f"))
    builder.tree["accessors"][0] |= changes.pop("accessor", {})
    builder.tree["bufferViews"][0] |= changes.pop("view", {})
    builder.tree |= changes
    return builder


SPARSE = {
    "count": 2,
    "indices": {"bufferView": 0, "componentType": 5121},
    "values": {"bufferView": 0},
}
FAULTS = {
    "count": (faulty(accessor={"count": 5}), "accessors[0].count"),
    "negative count": (faulty(accessor={"count": -1}), "accessors[0].count"),
    "huge count": (faulty(accessor={"count": 1 << 40}), "accessors[0].count"),
    "larger than an integer": (faulty(accessor={"count": 1 << 80}), "accessors[0].count"),
    "fraction": (faulty(accessor={"count": 1.5}), "accessors[0].count"),
    "boolean": (faulty(accessor={"count": True}), "accessors[0].count"),
    "component": (faulty(accessor={"componentType": 5124}), "accessors[0].componentType"),
    "type": (faulty(accessor={"type": "VEC5"}), "accessors[0].type"),
    "width": (faulty(accessor={"type": "SCALAR"}), "accessors[0].type"),
    "matrix": (faulty(accessor={"type": "MAT4"}), "accessors[0].type"),
    "offset": (faulty(accessor={"byteOffset": 4}), "accessors[0].count"),
    "negative offset": (faulty(accessor={"byteOffset": -4}), "accessors[0].byteOffset"),
    "huge offset": (faulty(accessor={"byteOffset": 1 << 50}), "accessors[0].count"),
    "view": (faulty(accessor={"bufferView": 1}), "accessors[0].bufferView"),
    "negative view": (faulty(accessor={"bufferView": -1}), "accessors[0].bufferView"),
    "large integers": (faulty(accessor={"componentType": 5125}), "here"),
    "view length": (faulty(view={"byteLength": 33}), "bufferViews[0].byteLength"),
    "view negative": (faulty(view={"byteLength": -1}), "bufferViews[0].byteLength"),
    "view offset": (faulty(view={"byteOffset": 1}), "bufferViews[0].byteLength"),
    "view before": (faulty(view={"byteOffset": -8}), "bufferViews[0].byteOffset"),
    "view buffer": (faulty(view={"buffer": 1}), "bufferViews[0].buffer"),
    "small stride": (faulty(view={"byteStride": 4}), "bufferViews[0].byteStride"),
    "negative stride": (faulty(view={"byteStride": -8}), "bufferViews[0].byteStride"),
    "large stride": (faulty(view={"byteStride": 252}), "accessors[0].count"),
    "buffer too short": (
        faulty(buffers=[{"byteLength": 32, "uri": "data:;base64,AAAA"}]),
        "buffers[0].byteLength",
    ),
    "no bytes": (faulty(buffers=[{"byteLength": 32}]), "buffers[0].uri"),
    "bad base64": (
        faulty(buffers=[{"byteLength": 32, "uri": "data:;base64,A*A"}]),
        "buffers[0].uri",
    ),
    "no comma": (faulty(buffers=[{"byteLength": 32, "uri": "data:AAAA"}]), "buffers[0].uri"),
    "missing file": (faulty(buffers=[{"byteLength": 32, "uri": "a.bin"}]), "buffers[0].uri"),
    "sparse count": (
        faulty(accessor={"sparse": SPARSE | {"count": 5}}),
        "accessors[0].sparse.count",
    ),
    "sparse order": (faulty(accessor={"sparse": SPARSE}), "accessors[0].sparse.indices"),
    "sparse component": (
        faulty(
            accessor={
                "sparse": SPARSE | {"indices": {"bufferView": 0, "componentType": 5126}},
            }
        ),
        "accessors[0].sparse.indices.componentType",
    ),
    "sparse without values": (
        faulty(accessor={"sparse": {"count": 1, "indices": SPARSE["indices"]}}),
        "accessors[0].sparse.values",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_faulty_accessor_is_refused_by_name(name):
    builder, field = FAULTS[name]
    with pytest.raises(InvalidInput) as raised:
        opened(builder)[0].floats(0, "here", (2,))
    assert raised.value.field == field


def test_a_sparse_index_beyond_the_accessor_is_refused():
    builder = Builder()
    where, values = builder.view(bytes([3, 9])), builder.view(bytes(16))
    sparse = {
        "count": 2,
        "indices": {"bufferView": where, "componentType": 5121},
        "values": {"bufferView": values},
    }
    layout = {"componentType": 5126, "count": 4, "type": "VEC2", "sparse": sparse}
    builder.add("accessors", layout)
    with pytest.raises(InvalidScene, match="outside"):
        opened(builder)[0].floats(0, "here", (2,))


def test_zeros_without_bytes_are_limited():
    builder = Builder(accessors=[{"componentType": 5126, "count": 3, "type": "VEC3"}])
    assert not opened(builder)[0].floats(0, "here", (3,)).any()
    builder.tree["accessors"][0]["count"] = 2_000_000
    with pytest.raises(LimitExceeded):
        opened(builder)[0].floats(0, "here", (3,))


def test_signed_or_float_indices_are_refused():
    for kind in "bhf":
        builder = Builder()
        builder.accessor(np.zeros(3, kind))
        with pytest.raises(InvalidScene, match="unsigned"):
            opened(builder)[0].indices(0, "here")
