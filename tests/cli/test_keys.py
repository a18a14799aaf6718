from pathlib import Path

import pytest

from raysvc.access import KeyStore, Scope
from raysvc.cli.app import run

Capture = pytest.CaptureFixture[str]


@pytest.fixture(autouse=True)
def data_dir(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("RAYSVC_DATA_DIR", str(tmp_path))
    return tmp_path


def test_a_key_is_printed_once_and_works(data_dir: Path, capsys: Capture) -> None:
    assert run(["keys", "add", "thumbnails", "--scope", "read"]) == 0
    key = capsys.readouterr().out.strip()
    entry = KeyStore(data_dir).check(key)
    assert entry is not None
    assert entry.scope is Scope.READ
    assert run(["keys", "list"]) == 0
    shown = capsys.readouterr().out
    assert entry.id in shown
    assert "thumbnails" in shown
    assert key.rpartition("_")[2] not in shown


def test_a_key_may_render_unless_it_is_said_otherwise(data_dir: Path, capsys: Capture) -> None:
    run(["keys", "add", "some"])
    entry = KeyStore(data_dir).check(capsys.readouterr().out.strip())
    assert entry is not None
    assert entry.scope is Scope.RENDER


def test_a_key_is_revoked_by_its_id(data_dir: Path, capsys: Capture) -> None:
    run(["keys", "add", "some"])
    key = capsys.readouterr().out.strip()
    assert run(["keys", "revoke", key.split("_")[1]]) == 0
    assert "is revoked" in capsys.readouterr().out
    assert KeyStore(data_dir).check(key) is None


def test_a_folder_may_be_named(tmp_path: Path, capsys: Capture) -> None:
    elsewhere = tmp_path / "elsewhere"
    run(["keys", "add", "some", "--data-dir", str(elsewhere)])
    assert KeyStore(elsewhere).check(capsys.readouterr().out.strip()) is not None


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (["keys", "revoke", "nothing"], "error: id: no key 'nothing'"),
        (["keys", "add", ""], "error: name: must be 1 to 100 printable characters"),
        (["keys", "add", "x", "--scope", "all"], "error: Invalid value for '--scope'"),
    ],
)
def test_wrong_words_are_refused(words: list[str], complaint: str, capsys: Capture) -> None:
    assert run(words) == 2
    assert capsys.readouterr().err.startswith(complaint)
