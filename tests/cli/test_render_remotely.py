"""`raysvc render --server` beside `raysvc render`: the same bytes, the same words."""

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from api.app import create_app
from api.settings import ApiSettings
from raysvc.access import KeyStore, Scope
from raysvc.cli.app import run
from tests.live import listening

Capture = pytest.CaptureFixture[str]

OBJ = "mtllib quad.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl red\nf 1 2 3 4\n"


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    folder = tmp_path_factory.mktemp("service")
    with listening(create_app(ApiSettings(data_dir=folder))) as url:
        yield url


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    (tmp_path / "quad.mtl").write_text("newmtl red\nKd 1 0 0\n")
    (tmp_path / "quad.obj").write_text(OBJ)
    return tmp_path / "quad.obj"


@pytest.mark.parametrize("suffix", ["png", "exr", "npz", "jpeg"])
def test_the_picture_is_the_same_to_the_byte(
    server: str, scene: Path, tmp_path: Path, suffix: str, capsys: Capture
) -> None:
    here, there = tmp_path / f"here.{suffix}", tmp_path / f"there.{suffix}"
    words = ["render", str(scene), "--size", "16x9", "-e", "builtin:studio"]
    words += ["--set", "bounces=1", "--set", "tone_map=agx"]
    assert run([*words, "-o", str(here)]) == 0
    assert run([*words, "-o", str(there), "--server", server]) == 0
    assert there.read_bytes() == here.read_bytes()
    first, second = capsys.readouterr().out.splitlines()
    assert first.partition(" in ")[0].replace("here", "there") == second.partition(" in ")[0]


def test_moved_vertices_and_a_probe_go_along(server: str, scene: Path, tmp_path: Path) -> None:
    positions = tmp_path / "positions.npy"
    np.save(positions, np.array([[0, 0, 0], [2, 0, 0], [1, 1, 0], [0, 1, 1]], np.float32))
    words = ["render", str(scene), "--size", "16x9", "--positions", str(positions)]
    words += ["--probe-at", "0.5,0.5,1", "--probe-size", "16", "-e", "builtin:gradient"]
    pictures = []
    for name, more in (("here", []), ("there", ["--server", server])):
        stats = tmp_path / f"{name}.json"
        picture = tmp_path / f"{name}.png"
        assert run([*words, "-o", str(picture), "--stats", str(stats), *more]) == 0
        assert json.loads(stats.read_text())["probe"]["at"] == [0.5, 0.5, 1.0]
        pictures.append(picture.read_bytes())
    assert pictures[0] == pictures[1]


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (["nothing.glb"], "error: nothing.glb: "),
        (["builtin:cornell", "-e", "no.hdr"], "error: no.hdr: "),
        (["builtin:cornell", "--set", "bounces=9"], "error: settings.bounces: "),
        (["builtin:atlantis"], "error: builtin: no built-in scene 'atlantis'"),
        (["builtin:cornell", "--probe-at", "1,2,3", "--set", "mode=reference"], "error: "),
    ],
)
def test_mistakes_end_as_they_do_here(
    server: str, tmp_path: Path, words: list[str], complaint: str, capsys: Capture
) -> None:
    picture = tmp_path / "picture.png"
    assert run(["render", *words, "-o", str(picture), "--server", server]) == 2
    assert capsys.readouterr().err.startswith(complaint)
    assert not picture.exists()


def test_an_address_where_nothing_is_ends_with_1(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    monkeypatch.setattr("raysvc.cli.render.PATIENCE_S", 0.0)
    words = ["render", "builtin:cornell", "-o", str(tmp_path / "x.png")]
    assert run([*words, "--server", "http://127.0.0.1:9"]) == 1
    assert capsys.readouterr().err.startswith("error: http://127.0.0.1:9")
    assert run([*words, "--server", "127.0.0.1:9"]) == 2


def test_a_key_comes_from_the_command_line_or_the_environment(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "data"
    key = KeyStore(folder).add("some", Scope.RENDER)
    with listening(create_app(ApiSettings(data_dir=folder))) as url:
        words = ["render", "builtin:cornell", "--size", "8x8", "-o", str(tmp_path / "x.png")]
        assert run([*words, "--server", url]) == 1
        assert run([*words, "--server", url, "--key", key]) == 0
        monkeypatch.setenv("RAYSVC_SERVER", url)
        monkeypatch.setenv("RAYSVC_KEY", key)
        assert run(words) == 0
