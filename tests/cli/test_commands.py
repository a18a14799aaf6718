import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import raysvc
from raysvc.cli.app import run
from raysvc.version import VERSION

Capture = pytest.CaptureFixture[str]


def test_a_scene_is_rendered_to_a_file_with_statistics(tmp_path: Path, capsys: Capture) -> None:
    picture, stats = tmp_path / "picture.png", tmp_path / "stats.json"
    words = ["render", "builtin:cornell", "--size", "24x16", "-e", "builtin:gradient"]
    words += ["--set", "occlusion_samples=4", "-o", str(picture), "--stats", str(stats)]
    assert run(words) == 0
    with Image.open(picture) as image:
        assert image.size == (24, 16)
    statistics = json.loads(stats.read_text())
    assert (statistics["width"], statistics["height"]) == (24, 16)
    shown = capsys.readouterr()
    assert shown.out.startswith(str(picture))
    assert shown.err == ""


def test_a_probe_takes_the_place_of_reflected_rays(tmp_path: Path, capsys: Capture) -> None:
    picture, stats = tmp_path / "picture.png", tmp_path / "stats.json"
    words = ["render", "builtin:cornell", "--size", "8x8", "-o", str(picture)]
    words += ["--probe-at", "0,1.5,-0.5", "--probe-size", "16", "--probe-without", "0"]
    assert run([*words, "--stats", str(stats)]) == 0
    statistics = json.loads(stats.read_text())
    assert statistics["probe"]["at"] == [0.0, 1.5, -0.5]
    assert statistics["probe"]["size"] == 16
    assert statistics["probe"]["left_out"] > 0
    assert "reflection" not in statistics["rays"]


@pytest.mark.parametrize("suffix", ["jpg", "webp", "exr", "npz"])
def test_the_suffix_names_the_format(tmp_path: Path, suffix: str) -> None:
    picture = tmp_path / f"picture.{suffix}"
    assert run(["render", "builtin:cornell", "--size", "8x8", "-o", str(picture)]) == 0
    assert picture.stat().st_size > 100


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (["render", "nothing.glb", "-o", "x.png"], "error: nothing.glb: "),
        (["render", "builtin:atlantis", "-o", "x.png"], "error: no built-in scene 'atlantis'"),
        (["render", "builtin:cornell", "-e", "no.hdr", "-o", "x.png"], "error: no.hdr: "),
        (["render", "builtin:cornell", "-o", "x.gif"], "error: --output: must end in .png"),
        (
            ["render", "builtin:cornell", "-o", "x.png", "--size", "0x0"],
            "error: camera.width: ",
        ),
        (
            ["render", "builtin:cornell", "-o", "x.png", "--set", "colour=red"],
            "error: settings.colour: unknown key",
        ),
        (
            ["render", "builtin:cornell", "-o", "x.png", "--set", "lens.order=1"],
            "error: settings.lens.order: unknown key",
        ),
        (
            ["render", "builtin:cornell", "-o", "x.png", "--set", "exposure_stops=NaN"],
            "error: settings.exposure_stops: ",
        ),
        (
            ["render", "builtin:cornell", "-o", "x.png", "--probe-at", "1,2"],
            "error: environment.probe_at: ",
        ),
        (
            ["render", "builtin:cornell", "-o", "x.png", "--probe-at", "1,2,up"],
            "error: environment.probe_at: ",
        ),
        (
            ["render", "builtin:cornell", "-o", "x.png", "--probe-size", "16"],
            "error: --probe-size: needs --probe-at",
        ),
        (["render", "builtin:cornell", "--speed", "3"], "error: No such option: --speed"),
        (["render"], "error: Missing argument"),
        (["paint"], "error: No such command 'paint'"),
        (["inspect", "nothing.glb"], "error: nothing.glb: "),
        (["demo", "--size", "tiny"], "error: --size: "),
        (["serve", "--port", "70000"], "error: Invalid value for '--port'"),
    ],
)
def test_wrong_input_ends_with_2_and_one_line(
    words: list[str],
    complaint: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: Capture,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(words) == 2
    shown = capsys.readouterr()
    assert shown.err.startswith(complaint)
    assert shown.err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_a_camera_file_with_nan_is_refused_by_name(tmp_path: Path, capsys: Capture) -> None:
    camera = tmp_path / "camera.json"
    camera.write_text('{"eye": [NaN, 0, 0]}')
    words = ["render", "builtin:cornell", "--camera", str(camera), "-o", str(tmp_path / "x.png")]
    assert run(words) == 2
    assert capsys.readouterr().err.startswith("error: camera.eye: ")


def test_a_scene_is_described_for_people_and_for_programs(capsys: Capture) -> None:
    assert run(["inspect", "builtin:cornell"]) == 0
    shown = capsys.readouterr().out
    assert "triangles" in shown and "materials" in shown
    assert run(["inspect", "builtin:cornell", "--json"]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["triangles"] == sum(m["triangles"] for m in summary["materials"])


def test_vertices_are_written_moved_and_rendered(tmp_path: Path, capsys: Capture) -> None:
    at_rest, moved = tmp_path / "rest.npy", tmp_path / "moved.npy"
    assert run(["inspect", "builtin:cornell", "--positions", str(at_rest)]) == 0
    positions = np.load(at_rest)
    scene = raysvc.load("builtin:cornell")
    np.testing.assert_array_equal(positions, scene.positions)
    np.save(moved, positions * [1.0, 0.8, 1.0])
    words = ["render", "builtin:cornell", "--size", "24x16", "--set", "occlusion_samples=4"]
    for file in (at_rest, moved):
        assert run([*words, "--positions", str(file), "-o", str(file.with_suffix(".png"))]) == 0
    assert run([*words, "-o", str(tmp_path / "plain.png")]) == 0
    plain = (tmp_path / "plain.png").read_bytes()
    assert at_rest.with_suffix(".png").read_bytes() == plain
    expected = raysvc.render(
        scene.deformed(np.load(moved)),
        camera={"width": 24, "height": 16},
        settings={"occlusion_samples": 4},
    )
    assert moved.with_suffix(".png").read_bytes() == expected.encode("png") != plain


def test_wrong_vertices_are_refused_by_name(tmp_path: Path, capsys: Capture) -> None:
    file, picture = tmp_path / "few.npy", tmp_path / "x.png"
    np.save(file, np.zeros((4, 3)))
    words = ["render", "builtin:cornell", "-o", str(picture), "--positions"]
    assert run([*words, str(file)]) == 2
    assert run([*words, str(tmp_path / "no.npy")]) == 2
    first, second = capsys.readouterr().err.splitlines()
    assert first.startswith("error: positions: needs the shape (449, 3), has (4, 3)")
    assert second.startswith("error: positions: the file no.npy is missing")
    assert not picture.exists()


def test_ctrl_c_ends_with_130(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("raysvc.cli.render.render_frame", interrupted)
    assert run(["render", "builtin:cornell", "-o", str(tmp_path / "x.png")]) == 130


def test_the_version_is_said(capsys: Capture) -> None:
    assert run(["--version"]) == 0
    assert capsys.readouterr().out == f"raysvc {VERSION}\n"


def test_no_command_at_all_shows_the_help(capsys: Capture) -> None:
    assert run([]) == 2
    assert "inspect" in capsys.readouterr().out
