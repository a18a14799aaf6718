import io
import struct
import zipfile

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from raysvc.errors import InvalidScene, LimitExceeded, RaysvcError
from raysvc.loading.shape_file import Shape, largest_shape_file, npy_of, npz_of, read_shape

POSITIONS = np.arange(15, dtype=np.float32).reshape(5, 3) / 7
NORMALS = np.roll(POSITIONS, 1, axis=0)


def npy(array, **options):
    file = io.BytesIO()
    np.lib.format.write_array(file, np.asanyarray(array), **options)
    return file.getvalue()


def npz(compressed=False, **files):
    file = io.BytesIO()
    kind = zipfile.ZIP_DEFLATED if compressed else zipfile.ZIP_STORED
    with zipfile.ZipFile(file, "w", kind) as archive:
        for name, data in files.items():
            archive.writestr(f"{name}.npy", data)
    return file.getvalue()


def claiming(shape, descr="<f4", numbers=b""):
    """An .npy file whose header says what it likes."""
    text = f"{{'descr': {descr!r}, 'fortran_order': False, 'shape': {shape}, }}\n".encode()
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text + numbers


@pytest.mark.parametrize("dtype", ["<f4", ">f4", "<f8", ">f8", "<f2", "<i4", ">u2"])
@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("version", [(1, 0), (2, 0)])
def test_npy_files_of_any_real_kind_are_read(dtype, order, version):
    values = np.array(POSITIONS * 10, dtype, order=order)
    shape = read_shape(npy(values, version=version), 5)
    np.testing.assert_array_equal(shape.positions, values)
    assert shape.normals is None


def test_bare_numbers_are_little_endian_and_single():
    shape = read_shape(POSITIONS.astype("<f4").tobytes(), 5)
    np.testing.assert_array_equal(shape.positions, POSITIONS)
    # Even where they begin like an archive.
    tricky = b"PK\x03\x04" + POSITIONS.tobytes()[4:]
    np.testing.assert_array_equal(read_shape(tricky, 5).positions[0, 1:], POSITIONS[0, 1:])


@pytest.mark.parametrize("normals", [None, NORMALS])
def test_what_is_written_is_read_again(normals):
    shape = read_shape(npz_of(Shape(POSITIONS, normals)), 5)
    np.testing.assert_array_equal(shape.positions, POSITIONS)
    assert (shape.normals is None) == (normals is None)
    np.testing.assert_array_equal(read_shape(npy_of(POSITIONS), 5).positions, POSITIONS)
    if normals is not None:
        np.testing.assert_array_equal(shape.normals, normals)


def test_archives_may_be_compressed():
    packed = npz(True, positions=npy(0 * POSITIONS), normals=npy(NORMALS))
    np.testing.assert_array_equal(read_shape(packed, 5).normals, NORMALS)


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (b"", "needs an .npy or .npz file, or 60 bytes"),
        (b"\0" * 59, "needs an .npy or .npz file, or 60 bytes"),
        (b"\x93NUMPY", "is not an .npy file"),
        (b"\x93NUMPY\x09\x00" + b"\0" * 52, "is not an .npy file"),
        (b"\x93NUMPY\x01\x00\xff\xff" + b"{" * 70000, "is not an .npy file"),
        (b"\x93NUMPY\x01\x00\x06\x00{'a':\n", "is not an .npy file"),
        (claiming((5, 3)), "has 0 bytes of numbers, not 60"),
        (claiming((5, 3), numbers=b"\0" * 61), "has 61 bytes of numbers, not 60"),
        (claiming((10**15, 3)), "needs the shape (5, 3), has (1000000000000000, 3)"),
        (claiming((15,), numbers=b"\0" * 60), "needs the shape (5, 3), has (15,)"),
        (claiming((5, 3), "|O", b"\0" * 120), "needs real numbers of at most 64 bits, has object"),
        (claiming((5, 3), "<c8", b"\0" * 120), "at most 64 bits, has complex64"),
        (claiming((5, 3), "|S4", b"\0" * 60), "needs real numbers"),
        (claiming((5, 3), "<f16", b"\0" * 240), "at most 64 bits"),
        (npy(np.zeros(5, [("x", "f4"), ("y", "f8")])), "needs real numbers"),
        (npz(position=npy(POSITIONS)), "holds 'position.npy'; known are positions and normals"),
        (npz(normals=npy(NORMALS)), "is missing from the archive"),
        (npz(positions=npy(POSITIONS[:4])), "needs the shape (5, 3), has (4, 3)"),
        (npz(positions=b"PK"), "is not an .npy file"),
        (npz(positions=npy(POSITIONS))[:-30], "broken archive"),
    ],
)
def test_what_is_no_shape_is_refused(data, says):
    with pytest.raises(InvalidScene) as caught:
        read_shape(data, 5)
    assert says in caught.value.message


def test_wrong_normals_are_named():
    with pytest.raises(InvalidScene) as caught:
        read_shape(npz(positions=npy(POSITIONS), normals=npy(NORMALS[:2])), 5)
    assert caught.value.field == "normals"


def test_an_archive_is_not_unpacked_beyond_what_the_vertices_can_need():
    bomb = npz(True, positions=b"\0" * (50 << 20))
    assert len(bomb) < largest_shape_file(5) * 4
    with pytest.raises(LimitExceeded):
        read_shape(bomb, 5)
    with pytest.raises(LimitExceeded):
        read_shape(npz(positions=b"", normals=b"", more=b""), 5)


def test_the_largest_file_that_is_allowed_suffices():
    wide = np.random.default_rng(1).normal(size=(5, 3))
    assert len(npz_of(Shape(wide, wide))) <= largest_shape_file(5)


@settings(deadline=None, max_examples=200)
@given(st.binary(max_size=200), st.sampled_from([b"", b"\x93NUMPY\x01\x00", b"PK\x03\x04"]))
def test_any_bytes_are_read_or_refused(data, start):
    try:
        shape = read_shape(start + data, 5)
    except RaysvcError:
        return
    assert shape.positions.shape == (5, 3)
