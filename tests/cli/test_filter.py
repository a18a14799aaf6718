import json
import math
from pathlib import Path

import numpy as np
import pytest

import raysvc
from raysvc.cli.app import run

Capture = pytest.CaptureFixture[str]
WORDS = ["filter", "builtin:gradient", "--size", "32x16"]


def test_one_map_is_one_file_that_reads_back(tmp_path: Path, capsys: Capture) -> None:
    gradient = raysvc.load_environment("builtin:gradient")
    expected = 2.0 * raysvc.filtered_map(gradient, 0.5, 32, 16, yaw_deg=30.0)
    for suffix, tolerance in ((".exr", 1e-6), (".hdr", 0.01)):
        file = tmp_path / f"map{suffix}"
        words = [*WORDS, "-r", "0.5", "--yaw", "30", "--strength", "2", "-o", str(file)]
        assert run(words) == 0
        found = raysvc.load_environment(str(file)).radiance
        np.testing.assert_allclose(found, expected, rtol=tolerance, atol=tolerance)
    assert capsys.readouterr().out == ""


def test_several_maps_are_files_beside_each_other(tmp_path: Path) -> None:
    words = [*WORDS, "-r", "0", "-r", "0.25", "--irradiance", "-o", str(tmp_path / "sky.png")]
    assert run(words) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "sky_irradiance.png",
        "sky_roughness_0.png",
        "sky_roughness_0_25.png",
    ]


def test_an_npz_holds_them_all(tmp_path: Path) -> None:
    file = tmp_path / "sky.npz"
    assert run([*WORDS, "-r", "1", "--irradiance", "-o", str(file)]) == 0
    with np.load(file) as maps:
        np.testing.assert_allclose(maps["irradiance"], math.pi * maps["roughness_1"], rtol=1e-5)
        assert maps["irradiance"].shape == (16, 32, 3)


def test_harmonics_are_printed_or_written(tmp_path: Path, capsys: Capture) -> None:
    file = tmp_path / "sky.json"
    assert run(["filter", "builtin:gradient", "--yaw", "40", "--sh9", "-"]) == 0
    assert run(["filter", "builtin:gradient", "--yaw", "40", "--sh9", str(file)]) == 0
    text = capsys.readouterr().out
    assert text == file.read_text()
    expected = raysvc.sh9(raysvc.load_environment("builtin:gradient"), 40.0)
    assert json.loads(text) == expected.to_dict()


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        ([], "--output: say --output, or --sh9"),
        (["-r", "0.5"], "--output: say"),
        (["-r", "0.5", "--sh9", "-"], "--output: says where the maps go"),
        (["--size", "8x4", "--sh9", "-"], "--output: says where the maps go"),
        (["-o", "x.exr"], "--roughness: needs a roughness, or irradiance"),
        (["-o", "x.exr", "-r", "1.5"], "--roughness: must be 0 to 1, is 1.5"),
        (["-o", "x.exr", "-r", "nan"], "--roughness: must be 0 to 1, is nan"),
        (["-o", "x.exr", "-r", "0.5", "-r", "0.5"], "--roughness: has 0.5 twice"),
        (["-o", "x.exr", *(f"-r0.{n:02}" for n in range(1, 19))], "--roughness: must be at most"),
        (["-o", "x.jpg", "-r", "0.5"], "--output: must end in .exr .hdr .npz .png"),
        (["-o", "no/x.exr", "-r", "0.5"], "--output: there is no folder no"),
        (["-o", "x.exr", "-r", "0.5", "--size", "9000x8"], "--size: must be at most 4,096"),
        (["-o", "x.exr", "-r", "0.5", "--size", "8x0"], "--size: must be at least 1"),
        (["-o", "x.exr", "-r", "0.5", "--size", "big"], "--size: write WIDTHxHEIGHT"),
        (["--sh9", "x.json", "--yaw", "nan"], "Invalid value for '--yaw'"),
        (["-o", "x.exr", "-r", "0.5", "--strength", "nan"], "Invalid value for '--strength'"),
        (["--sh9", "x.txt"], "--sh9: must end in .json"),
    ],
)
def test_wrong_input_is_refused_by_its_option(
    words: list[str],
    complaint: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: Capture,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(["filter", "builtin:gradient", *words]) == 2
    shown = capsys.readouterr().err
    assert shown.startswith(f"error: {complaint}") and shown.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
