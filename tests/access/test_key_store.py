import os
import stat
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from raysvc.access import KeyStore, Scope
from raysvc.access.key import id_in
from raysvc.access.key_store import FILE
from raysvc.errors import InvalidSetting, NotFound, RaysvcError


@pytest.fixture
def store(tmp_path: Path) -> KeyStore:
    return KeyStore(tmp_path)


def id_of(key: str) -> str:
    id = id_in(key)
    assert id is not None
    return id


def test_a_key_is_known_and_nothing_near_it_is(store: KeyStore) -> None:
    key = store.add("thumbnails", Scope.RENDER)
    entry = store.check(key)
    assert entry is not None
    assert (entry.name, entry.scope, entry.id) == ("thumbnails", Scope.RENDER, id_of(key))
    last = "0" if key[-1] != "0" else "1"
    other = store.add("other", Scope.ADMIN)
    mixed = f"raysvc_{id_of(key)}_{other.rpartition('_')[2]}"
    for near in (
        key[:-1] + last,
        key[:-1],
        key + "0",
        key.upper(),
        f" {key}",
        "",
        "raysvc__",
        mixed,
    ):
        assert store.check(near) is None, near
    # A key that has the form of one, but was never handed out.
    assert store.check(f"raysvc_{'0' * 12}_{'0' * 64}") is None


def test_a_key_cannot_be_read_from_the_file(store: KeyStore, tmp_path: Path) -> None:
    key = store.add("thumbnails", Scope.READ)
    kept = b"".join(path.read_bytes() for path in tmp_path.iterdir())
    assert id_of(key).encode() in kept
    secret = key.rpartition("_")[2]
    assert secret.encode() not in kept
    assert bytes.fromhex(secret) not in kept


@pytest.mark.skipif(os.name == "nt", reason="other permissions")
def test_only_the_owner_reads_the_file(store: KeyStore, tmp_path: Path) -> None:
    store.add("thumbnails", Scope.READ)
    assert stat.S_IMODE((tmp_path / FILE).stat().st_mode) == 0o600


def test_a_revoked_key_lets_nobody_in_and_stays_in_the_list(store: KeyStore) -> None:
    key = store.add("thumbnails", Scope.READ)
    first = store.revoke(id_of(key))
    assert first.revoked_s is not None
    assert store.check(key) is None
    assert store.revoke(id_of(key)).revoked_s == first.revoked_s
    assert [entry.id for entry in store.keys()] == [id_of(key)]


def test_who_revokes_the_last_key_does_not_open_the_service(tmp_path: Path) -> None:
    store = KeyStore(tmp_path)
    assert not store.guarded
    store.revoke(id_of(store.add("only", Scope.ADMIN)))
    assert store.guarded
    assert KeyStore(tmp_path).guarded


def test_a_file_that_goes_away_does_not_open_a_service_that_runs(
    store: KeyStore, tmp_path: Path
) -> None:
    store.add("only", Scope.ADMIN)
    assert store.guarded
    (tmp_path / FILE).unlink()
    assert store.guarded


def test_looking_makes_no_file(store: KeyStore, tmp_path: Path) -> None:
    assert store.keys() == []
    assert store.check(f"raysvc_{'0' * 12}_{'0' * 64}") is None
    assert not store.guarded
    with pytest.raises(NotFound):
        store.revoke("0" * 12)
    assert list(tmp_path.iterdir()) == []


def test_keys_of_another_process_count_at_once(store: KeyStore, tmp_path: Path) -> None:
    assert not store.guarded
    words = "import sys; from pathlib import Path; from raysvc.access import KeyStore, Scope\n"
    words += "print(KeyStore(Path(sys.argv[1])).add('elsewhere', Scope.READ))"
    done = subprocess.run(
        [sys.executable, "-c", words, str(tmp_path)], capture_output=True, text=True, check=True
    )
    assert store.guarded
    assert store.check(done.stdout.strip()) is not None


@pytest.mark.parametrize("name", ["", "x" * 101, "two\nlines", "bell\a"])
def test_a_name_that_would_break_a_list_is_refused(store: KeyStore, name: str) -> None:
    with pytest.raises(InvalidSetting) as raised:
        store.add(name, Scope.READ)
    assert raised.value.field == "name"


def test_a_damaged_file_is_an_error_and_not_an_open_door(store: KeyStore, tmp_path: Path) -> None:
    (tmp_path / FILE).write_bytes(b"not a database" * 100)
    with pytest.raises(RaysvcError, match=FILE):
        _ = store.guarded


def test_many_threads_may_ask_and_add(store: KeyStore) -> None:
    key = store.add("first", Scope.READ)
    wrong: list[object] = []

    def work() -> None:
        for number in range(20):
            if store.check(key) is None:
                wrong.append(number)
            store.add(f"number {number}", Scope.READ)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong
    assert len(store.keys()) == 81


def test_the_file_is_read_when_it_has_changed_and_then_alone(
    store: KeyStore, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    key = store.add("first", Scope.READ)
    read: list[int] = []
    known = store.keys
    monkeypatch.setattr(store, "keys", lambda: [read.append(1), *known()][1:])
    for _ in range(3):
        assert store.check(key) is not None
    assert len(read) == 1
    # As fast as it goes: a time of change would not tell these apart.
    for number in range(2, 12):
        other = KeyStore(tmp_path)
        added = other.add(f"number {number}", Scope.READ)
        other.close()
        assert not store.is_fresh
        assert store.check(added) is not None
        assert store.is_fresh
        assert len(read) == number


def test_another_file_in_its_place_counts(store: KeyStore, tmp_path: Path) -> None:
    old = store.add("old", Scope.READ)
    assert store.check(old) is not None
    (tmp_path / FILE).unlink()
    other = KeyStore(tmp_path)
    new = other.add("new", Scope.READ)
    assert store.check(old) is None
    assert store.check(new) is not None
