import json
import threading
from pathlib import Path

import pytest

from raysvc.errors import InvalidScene, InvalidSetting, NotFound
from raysvc.jobs import ContentStore, Upload
from raysvc.jobs.store import Kind


def text_kind(loads: list[str] | None = None) -> Kind[str]:
    """Things that are texts: the store does not care."""

    def load(source: str | Upload) -> str:
        if isinstance(source, str):
            text = source
        else:
            text = source.files[source.main or min(source.files)].decode()
        if loads is not None:
            loads.append(text)
        if text == "builtin:unknown":
            raise NotFound("no such built-in text")
        if "bad" in text:
            raise InvalidScene("is bad", field="text")
        return text

    return Kind(
        name="text",
        load=load,
        summarise=lambda text: {"letters": len(text)},
        weigh=len,
    )


def upload(text: str, name: str = "a.txt") -> Upload:
    return Upload({name: text.encode()})


def everything_in(folder: Path) -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))


def test_the_same_content_is_one_thing(tmp_path: Path) -> None:
    store = ContentStore(tmp_path, text_kind(), 1000)
    first, new = store.add(upload("hello"))
    again, new_again = store.add(upload("hello"))
    assert new and not new_again
    assert first == again
    assert len(first.id) == 64
    assert store.add(upload("other"))[0].id != first.id


def test_the_name_of_a_thing_does_not_depend_on_the_order_of_its_files() -> None:
    assert Upload({"a": b"1", "b": b"2"}).id == Upload({"b": b"2", "a": b"1"}).id
    assert Upload({"a": b"1", "b": b"2"}).id != Upload({"a": b"2", "b": b"1"}).id
    assert Upload({"a": b"12"}).id != Upload({"a1": b"2"}).id


def test_things_are_still_known_after_a_restart(tmp_path: Path) -> None:
    before = ContentStore(tmp_path, text_kind(), 1000)
    record, _ = before.add(Upload({"a.txt": b"hello", "folder/b.txt": b"side"}, main="a.txt"))
    builtin, _ = before.add_builtin("sky")
    after = ContentStore(tmp_path, text_kind(), 1000)
    assert {known.id for known in after.records()} == {record.id, builtin.id}
    assert after.record(record.id) == record
    assert after.get(record.id) == "hello"
    assert after.get(builtin.id) == "builtin:sky"


def test_bad_content_leaves_nothing_behind(tmp_path: Path) -> None:
    store = ContentStore(tmp_path, text_kind(), 1000)
    before = everything_in(tmp_path)
    with pytest.raises(InvalidScene):
        store.add(upload("bad"))
    with pytest.raises(InvalidSetting, match="no such built-in text"):
        store.add_builtin("unknown")
    assert everything_in(tmp_path) == before
    assert store.records() == []


def test_no_name_that_a_caller_sends_becomes_a_file_name(tmp_path: Path) -> None:
    store = ContentStore(tmp_path, text_kind(), 1000)
    record, _ = store.add(upload("hello", "strange name ü.txt"))
    names = [path.name for path in (tmp_path / record.id).iterdir()]
    assert sorted(names) == ["0", "record.json"]


def test_what_does_not_fit_into_memory_is_parsed_again(tmp_path: Path) -> None:
    loads: list[str] = []
    store = ContentStore(tmp_path, text_kind(loads), 8)
    first, _ = store.add(upload("first"))
    store.get(first.id)
    assert loads == ["first"]
    store.add(upload("second"))
    assert store.get(first.id) == "first"
    assert loads == ["first", "second", "first"]


def test_what_is_deleted_is_gone(tmp_path: Path) -> None:
    store = ContentStore(tmp_path, text_kind(), 1000)
    before = everything_in(tmp_path)
    record, _ = store.add(upload("hello"))
    store.delete(record.id)
    with pytest.raises(NotFound):
        store.get(record.id)
    with pytest.raises(NotFound):
        store.delete(record.id)
    assert everything_in(tmp_path) == before
    assert store.add(upload("hello"))[1]


def test_damaged_and_unfinished_entries_are_passed_over(tmp_path: Path) -> None:
    store = ContentStore(tmp_path, text_kind(), 1000)
    good, _ = store.add(upload("good"))
    for number, text in enumerate(["{", "[]", "{}", json.dumps({"files": 3})]):
        damaged = tmp_path / (str(number) * 64)
        damaged.mkdir()
        (damaged / "record.json").write_text(text)
    (tmp_path / "incoming" / "half").mkdir()
    again = ContentStore(tmp_path, text_kind(), 1000)
    assert [record.id for record in again.records()] == [good.id]
    assert list((tmp_path / "incoming").iterdir()) == []


def test_many_threads_that_send_the_same_thing_make_one(tmp_path: Path) -> None:
    store = ContentStore(tmp_path, text_kind(), 1000)
    answers: list[tuple[str, bool]] = []
    gate = threading.Barrier(8)

    def send() -> None:
        gate.wait()
        record, new = store.add(upload("hello"))
        answers.append((record.id, new))

    threads = [threading.Thread(target=send) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len({id for id, _ in answers}) == 1
    assert sum(new for _, new in answers) == 1
    assert list((tmp_path / "incoming").iterdir()) == []
