import errno
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from raysvc.errors import StorageFull
from raysvc.jobs import ResultFolder
from raysvc.jobs.array_file import read_arrays, write_arrays
from raysvc.jobs.disk_budget import DiskCounts

BIG = 1 << 30


def layers(value: float = 1.0) -> dict[str, np.ndarray]:
    return {"beauty": np.full((4, 8, 4), value, np.float32), "id": np.arange(32, dtype=np.int32)}


def names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir() if path.is_file()}


@given(
    st.dictionaries(
        st.text(max_size=8),
        hnp.arrays(
            st.sampled_from([np.float32, np.int32, np.uint8]),
            hnp.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=5),
        ),
        max_size=4,
    ),
    st.dictionaries(st.text(max_size=5), st.floats(allow_nan=False, allow_infinity=False)),
)
def test_arrays_are_read_as_they_were_written(
    tmp_path_factory: pytest.TempPathFactory, arrays: dict[str, np.ndarray], about: dict[str, float]
) -> None:
    path = tmp_path_factory.mktemp("arrays") / "file"
    with path.open("wb") as file:
        write_arrays(file, about, arrays)
    read_about, read = read_arrays(path)
    assert read_about == about
    assert list(read) == list(arrays)
    for name, array in arrays.items():
        assert read[name].dtype == array.dtype and read[name].shape == array.shape
        assert read[name].tobytes() == array.tobytes()


def test_arrays_that_were_read_cannot_be_written_to(tmp_path: Path) -> None:
    folder = ResultFolder(tmp_path, BIG)
    folder.put("a", {}, layers())
    kept = folder.get("a")
    assert kept is not None
    with pytest.raises(ValueError, match="read-only"):
        kept[1]["beauty"][0] = 1


def test_what_was_put_is_found_by_the_next_process(tmp_path: Path) -> None:
    ResultFolder(tmp_path, BIG).put("a", {"seconds": 0.1 + 0.2}, layers(0.5))
    kept = ResultFolder(tmp_path, BIG).get("a")
    assert kept is not None
    about, arrays = kept
    assert about == {"seconds": 0.1 + 0.2}
    np.testing.assert_array_equal(arrays["beauty"], layers(0.5)["beauty"])
    assert ResultFolder(tmp_path, BIG).get("b") is None


def test_what_was_not_asked_for_longest_makes_room(tmp_path: Path) -> None:
    folder = ResultFolder(tmp_path / "one", BIG)
    folder.put("a", {}, layers())
    size = folder.counts.held_bytes
    assert size == (tmp_path / "one" / "a").stat().st_size
    folder = ResultFolder(tmp_path / "three", 3 * size)
    for name in "abc":
        folder.put(name, {}, layers())
    folder.get("a")
    folder.put("d", {}, layers())
    assert names(tmp_path / "three") == {"a", "c", "d"}
    assert folder.counts == DiskCounts(evictions=1, held_bytes=3 * size)
    # The order outlives the process, and a smaller budget is kept from its beginning.
    ResultFolder(tmp_path / "three", 2 * size)
    assert names(tmp_path / "three") == {"a", "d"}


def test_the_newest_is_kept_whatever_it_weighs(tmp_path: Path) -> None:
    folder = ResultFolder(tmp_path, 1)
    for name in "ab":
        folder.put(name, {}, layers())
    assert names(tmp_path) == {"b"}


@pytest.mark.parametrize("keep", [0, 10, 40, 200, -1])
def test_a_file_that_was_cut_off_is_dropped_and_never_read(tmp_path: Path, keep: int) -> None:
    folder = ResultFolder(tmp_path, BIG)
    folder.put("a", {}, layers())
    path = tmp_path / "a"
    path.write_bytes(path.read_bytes()[:keep])
    assert folder.get("a") is None
    assert not path.exists()
    folder.put("a", {}, layers())
    assert folder.get("a") is not None


def test_what_is_half_written_is_not_seen_and_is_swept_up(tmp_path: Path) -> None:
    draft = tmp_path / "incoming" / "draft"
    draft.parent.mkdir()
    draft.write_bytes(b"half")
    assert ResultFolder(tmp_path, BIG).counts.held_bytes == 0
    assert not draft.exists()


def test_what_cannot_be_written_leaves_nothing(tmp_path: Path) -> None:
    folder = ResultFolder(tmp_path, BIG)
    with pytest.raises(ValueError, match="JSON"):
        folder.put("a", {"seconds": float("nan")}, layers())
    assert folder.get("a") is None
    assert not list((tmp_path / "incoming").iterdir())


def test_a_full_disk_takes_the_oldest_results_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = ResultFolder(tmp_path, BIG)
    for name in "ab":
        folder.put(name, {}, layers())

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr("raysvc.jobs.result_folder.write_file", full)
        with pytest.raises(StorageFull):
            folder.put("c", {}, layers())
    assert names(tmp_path) == set()
    assert folder.counts == DiskCounts(evictions=2, held_bytes=0)
    folder.put("c", {}, layers())
    assert names(tmp_path) == {"c"}


@pytest.mark.parametrize(("code", "most"), [(errno.ENOSPC, 2), (errno.EDQUOT, 2), (errno.EFBIG, 0)])
def test_what_does_not_fit_takes_no_more_of_the_others_than_it_needs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, code: int, most: int
) -> None:
    folder = ResultFolder(tmp_path, BIG)
    big = {"beauty": np.zeros((256, 256, 4), np.float32)}
    for name in "abcdefgh":
        folder.put(name, {}, big)

    def full(*_: object) -> None:
        raise OSError(code, "No room")

    monkeypatch.setattr("raysvc.jobs.result_folder.write_file", full)
    with pytest.raises(StorageFull):
        folder.put("i", {}, big)
    assert names(tmp_path) == set("abcdefgh"[most:])
