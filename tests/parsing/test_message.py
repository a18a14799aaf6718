"""Messages: what is written is read; what is forged is refused, and never more than that."""

import json
import os
import tempfile
from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from raysvc.parsing.message import (
    ALIGNMENT,
    DTYPES,
    MAGIC,
    BadMessage,
    Message,
    read_message,
    write_message,
)

ENOUGH = 1 << 20
ARRAYS = st.lists(
    st.sampled_from(DTYPES).flatmap(
        lambda dtype: hnp.arrays(dtype, hnp.array_shapes(min_dims=1, max_dims=4, min_side=0))
    ),
    max_size=4,
)
FIELDS = st.dictionaries(
    st.text(), st.recursive(st.text() | st.integers() | st.none(), st.lists, max_leaves=5)
)


@pytest.fixture
def file() -> Iterator[int]:
    with tempfile.TemporaryFile() as opened:
        yield opened.fileno()


def written(file: int, data: bytes) -> int:
    os.ftruncate(file, 0)
    os.pwrite(file, data, 0)
    return file


def message_bytes(header: object, rest: bytes = b"") -> bytes:
    text = json.dumps(header).encode()
    return MAGIC + len(text).to_bytes(8, "little") + text + rest


@given(FIELDS, ARRAYS)
def test_what_is_written_is_read(fields: dict[str, object], arrays: list[np.ndarray]) -> None:
    with tempfile.TemporaryFile() as opened:
        write_message(opened.fileno(), Message(fields, arrays))
        found = read_message(opened.fileno(), ENOUGH)
    assert found.fields == fields
    assert len(found.arrays) == len(arrays)
    for one, other in zip(found.arrays, arrays, strict=True):
        assert one.dtype == other.dtype and one.shape == other.shape
        assert one.tobytes() == other.tobytes()


def test_a_shorter_message_replaces_a_longer_one(file: int) -> None:
    write_message(file, Message({"n": 1}, [np.ones(1000, np.float32)]))
    write_message(file, Message({"n": 2}))
    assert os.fstat(file).st_size < 100
    assert read_message(file, ENOUGH).fields == {"n": 2}


def test_an_array_that_is_read_is_out_of_the_writers_reach(file: int) -> None:
    write_message(file, Message({}, [np.zeros(64, np.uint8)]))
    (array,) = read_message(file, ENOUGH).arrays
    os.pwrite(file, b"\xff" * 1024, 0)
    assert not array.any()


@pytest.mark.parametrize(
    ("header", "what"),
    [
        ([], "header"),
        ({"fields": {}}, "arrays"),
        ({"fields": [], "arrays": []}, "shape"),
        ({"fields": {}, "arrays": 3}, "header"),
        ({"fields": {}, "arrays": [["|O8", [1]]]}, "dtype"),
        ({"fields": {}, "arrays": [[["|u1"], [1]]]}, "header"),
        ({"fields": {}, "arrays": [["|u1", [-1]]]}, "size"),
        ({"fields": {}, "arrays": [["|u1", [True]]]}, "size"),
        ({"fields": {}, "arrays": [["|u1", [1 << 62, 1 << 62]]]}, "size"),
        ({"fields": {}, "arrays": [["|u1", [1 << 39, 1 << 39, 0]]]}, "size"),
        ({"fields": {}, "arrays": [["|u1", [1] * 9]]}, "dimensions"),
        ({"fields": {}, "arrays": [["<f8", [1 << 30]]]}, "less"),
        ({"fields": {}, "arrays": [["|u1", [1]]] * 200_000}, "shape"),
    ],
)
def test_a_forged_header_is_refused(file: int, header: object, what: str) -> None:
    written(file, message_bytes(header))
    with pytest.raises(BadMessage, match=what):
        read_message(file, 1 << 24)


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"short",
        b"otherway" + bytes(8),
        MAGIC + b"\xff" * 8,
        MAGIC + (2).to_bytes(8, "little") + b"\xff\xff",
        MAGIC + (200_000).to_bytes(8, "little") + b"[" * 200_000,
        message_bytes({"fields": {}, "arrays": [["|u1", [64]]]}, bytes(ALIGNMENT)[:3]),
    ],
)
def test_what_is_no_message_is_refused(file: int, data: bytes) -> None:
    with pytest.raises(BadMessage):
        read_message(written(file, data), ENOUGH)


def test_a_message_that_is_too_large_is_not_read(file: int) -> None:
    write_message(file, Message({}, [np.zeros(1000, np.uint8)]))
    with pytest.raises(BadMessage, match="bytes"):
        read_message(file, 500)


@given(st.binary(max_size=300), st.integers(0, 400))
def test_damage_makes_a_bad_message_or_another_message(damage: bytes, place: int) -> None:
    with tempfile.TemporaryFile() as opened:
        file = opened.fileno()
        write_message(file, Message({"a": [1, 2]}, [np.arange(20, dtype=np.float32)]))
        os.pwrite(file, damage, place)
        try:
            read_message(file, ENOUGH)
        except BadMessage:
            pass


def test_other_dtypes_are_not_written(file: int) -> None:
    with pytest.raises(TypeError):
        write_message(file, Message({}, [np.array([object()])]))
