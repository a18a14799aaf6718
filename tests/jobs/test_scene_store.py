"""Deformed scenes in the store: named by content, on their own, sharing what is in memory."""

import gc
import os
import weakref
from pathlib import Path

import numpy as np
import pytest

from raysvc.errors import InvalidScene, NotFound
from raysvc.jobs import Record, SceneStore, Upload
from raysvc.jobs.kinds import scene_kind
from raysvc.loading.shape_file import Shape
from raysvc.parsing import Parser, ParserOptions
from tests.api.glb import POSITIONS, glb, gltf

TRIANGLE = np.frombuffer(POSITIONS, np.float32).reshape(3, 3)
BENT = TRIANGLE + np.float32([[0, 0, 1], [0, 0, 0], [0.5, 0, 0]])


def store_in(folder: Path, memory_bytes: int = 1 << 20) -> SceneStore:
    return SceneStore(folder, scene_kind(Parser(ParserOptions(processes=0))), memory_bytes)


def add(store: SceneStore) -> Record:
    return store.add(Upload({"triangle.glb": glb()}))[0]


def test_a_shape_is_a_scene_of_its_own(tmp_path: Path) -> None:
    store = store_in(tmp_path)
    origin = add(store)
    record, new = store.add_shape(origin.id, Shape(BENT))
    assert new and record.id != origin.id
    assert (record.rest, record.builtin, len(record.id)) == (origin.id, None, 64)
    assert record.summary["bounds"]["max"] == BENT.max(axis=0).tolist()
    np.testing.assert_array_equal(store.get(record.id).positions, BENT)
    np.testing.assert_array_equal(store.get(origin.id).positions, TRIANGLE)
    assert {known.id for known in store.records()} == {origin.id, record.id}


def test_the_same_numbers_are_the_same_scene_whichever_shape_they_are_sent_for(
    tmp_path: Path,
) -> None:
    store = store_in(tmp_path)
    origin = add(store)
    first, _ = store.add_shape(origin.id, Shape(BENT))
    again, new = store.add_shape(origin.id, Shape(BENT.astype(np.float64)))
    assert (again, new) == (first, False)
    far, _ = store.add_shape(first.id, Shape(2 * BENT))
    assert far.rest == origin.id
    assert store.add_shape(far.id, Shape(BENT)) == (first, False)
    assert store.add_shape(far.id, Shape(TRIANGLE)) == (origin, False)
    lit, new = store.add_shape(origin.id, Shape(BENT, np.ones((3, 3))))
    assert new and lit.id != first.id
    np.testing.assert_allclose(store.get(lit.id).normals, 3**-0.5, atol=1e-6)


def test_shapes_are_known_after_a_restart(tmp_path: Path) -> None:
    before = store_in(tmp_path)
    records = [before.add_shape(add(before).id, Shape(BENT))[0]]
    records.append(before.add_shape(records[0].id, Shape(2 * BENT, np.ones((3, 3))))[0])
    builtin = before.add_builtin("cornell")[0]
    positions = before.get(builtin.id).positions * np.float32(2)
    records.append(before.add_shape(builtin.id, Shape(positions))[0])
    scenes = [before.get(record.id) for record in records]
    after = store_in(tmp_path)
    for record, scene in zip(records, scenes, strict=True):
        assert after.record(record.id) == record
        for name in ("positions", "normals", "tangents", "triangles"):
            np.testing.assert_array_equal(getattr(after.get(record.id), name), getattr(scene, name))
    assert records[2].rest_builtin == "cornell"


def test_a_shape_outlives_the_scene_that_it_was_made_from(tmp_path: Path) -> None:
    store = store_in(tmp_path)
    files = {"scene.gltf": gltf("side/points.bin"), "side/points.bin": POSITIONS}
    origin, _ = store.add(Upload(files))
    record, _ = store.add_shape(origin.id, Shape(BENT))
    store.delete(origin.id)
    with pytest.raises(NotFound):
        store.get(origin.id)
    for place in (store, store_in(tmp_path)):
        np.testing.assert_array_equal(place.get(record.id).positions, BENT)
        back, _ = place.add_shape(record.id, Shape(TRIANGLE))
        np.testing.assert_array_equal(place.get(back.id).positions, TRIANGLE)
        place.delete(back.id)
    store_in(tmp_path).delete(record.id)
    assert [path.name for path in tmp_path.iterdir()] == ["incoming"]


def test_files_are_kept_once(tmp_path: Path) -> None:
    store = store_in(tmp_path)
    origin = add(store)
    record, _ = store.add_shape(origin.id, Shape(BENT))
    assert os.path.samefile(tmp_path / origin.id / "0", tmp_path / record.id / "0")


def test_files_are_copied_where_they_cannot_be_linked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise PermissionError

    monkeypatch.setattr(os, "link", refuse)
    store = store_in(tmp_path)
    origin = add(store)
    record, _ = store.add_shape(origin.id, Shape(BENT))
    assert (tmp_path / record.id / "0").read_bytes() == glb()


def test_what_had_to_make_room_is_made_from_a_shape_that_is_in_memory(tmp_path: Path) -> None:
    store = store_in(tmp_path, memory_bytes=1)  # keeps the last scene only
    origin = add(store)
    first, _ = store.add_shape(origin.id, Shape(BENT))
    held = store.get(first.id)
    second, _ = store.add_shape(first.id, Shape(2 * BENT))
    assert store.get(second.id).rest is held.rest
    again = store.get(first.id)
    assert again is not held and again.rest is held.rest
    np.testing.assert_array_equal(again.normals, held.normals)


def test_a_family_that_nobody_holds_leaves_memory(tmp_path: Path) -> None:
    store = store_in(tmp_path, memory_bytes=1)
    first, _ = store.add_shape(add(store).id, Shape(BENT))
    rest = weakref.ref(store.get(first.id).rest)
    assert rest() is not None
    store.add_builtin("cornell")
    gc.collect()
    assert rest() is None
    np.testing.assert_array_equal(store.get(first.id).positions, BENT)


def test_bad_shapes_leave_nothing_behind(tmp_path: Path) -> None:
    store = store_in(tmp_path)
    origin = add(store)
    before = sorted(tmp_path.rglob("*"))
    for shape, field in (
        (Shape(BENT[:2]), "positions"),
        (Shape(BENT * np.nan), "positions"),
        (Shape(BENT, 0 * BENT), "normals"),
    ):
        with pytest.raises(InvalidScene) as caught:
            store.add_shape(origin.id, shape)
        assert caught.value.field == field
    with pytest.raises(NotFound):
        store.add_shape("0" * 64, Shape(BENT))
    assert sorted(tmp_path.rglob("*")) == before
    assert store.records() == [origin]


def test_shapes_of_another_version_are_passed_over(tmp_path: Path) -> None:
    # Their vertices might be in another order by now.
    store = store_in(tmp_path)
    origin = add(store)
    record, _ = store.add_shape(origin.id, Shape(BENT))
    file = tmp_path / record.id / "record.json"
    file.write_text(file.read_text().replace(f'"version": "{record.version}"', '"version": "0"'))
    assert [known.id for known in store_in(tmp_path).records()] == [origin.id]
