import json
from pathlib import Path

import pytest
from PIL import Image

from raysvc.cli.app import run

Capture = pytest.CaptureFixture[str]
COMPARE = ["compare", "builtin:cornell", "--count", "200", "--rounds", "1"]


def test_structures_are_compared_into_files(tmp_path: Path, capsys: Capture) -> None:
    figures, chart, costs = tmp_path / "f.json", tmp_path / "c.svg", tmp_path / "h.png"
    words = [*COMPARE, "--rays", "diffuse", "--seed", "3", "--structures", "embree,bvh:max_leaf=2"]
    words += ["--trees", "per_material", "--size", "32x24", "-o", str(figures)]
    assert run([*words, "--chart", str(chart), "--heat-map", str(costs)]) == 0
    measured = json.loads(figures.read_text())
    assert measured["scene"] == "builtin:cornell"
    assert measured["rays"] == {"kind": "diffuse", "count": 200, "seed": 3}
    assert [(s["name"], s["trees"]) for s in measured["structures"]] == [
        ("embree", "per_material"),
        ("bvh:max_leaf=2", "per_material"),
    ]
    assert "<svg" in chart.read_text()
    Image.open(costs).verify()
    shown = capsys.readouterr()
    assert "bvh" in shown.out
    assert shown.err == ""


@pytest.mark.parametrize("suffix", ["csv", "md"])
def test_the_suffix_names_the_table(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"figures.{suffix}"
    assert run([*COMPARE, "--structures", "brute", "-o", str(path)]) == 0
    assert "brute" in path.read_text()


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (["p.png", "--rays", "random"], "error: --rays: cannot be given together with --pictures"),
        (["p.png", "--scaling"], "error: --scaling: cannot be given together with --pictures"),
        (["p.png", "--chart", "c.svg"], "error: --chart: cannot be given together with"),
        (["p.jpg"], "error: --pictures: must end in .png"),
        (["p.png", "-o", "f.csv"], "error: --output: must end in .json"),
        (["p.png", "--set", "bounces=9"], "error: settings.bounces: "),
        (["p.png", "--samples", "0"], "error: settings.samples: "),
        (["p.png", "--size", "0x4"], "error: camera.width: "),
        (["p.png", "-e", "nowhere.hdr"], "error: nowhere.hdr: "),
    ],
)
def test_wrong_words_for_pictures_are_refused(
    words: list[str],
    complaint: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: Capture,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(["compare", "builtin:cornell", "--pictures", *words]) == 2
    assert capsys.readouterr().err.startswith(complaint)
    assert list(tmp_path.iterdir()) == []


def test_a_picture_is_compared_with_its_reference(tmp_path: Path, capsys: Capture) -> None:
    picture, figures = tmp_path / "p.png", tmp_path / "f.json"
    words = ["compare", "builtin:cornell", "--pictures", str(picture), "-o", str(figures)]
    words += ["-e", "builtin:gradient", "--size", "20x16", "--samples", "2"]
    assert run([*words, "--set", "occlusion_samples=2", "--set", "exposure_stops=-1"]) == 0
    with Image.open(picture) as image:
        assert image.size == (60, 16)
    measured = json.loads(figures.read_text())
    assert measured["scene"] == "builtin:cornell"
    assert measured["environment"] == "builtin:gradient"
    assert measured["settings"]["exposure_stops"] == -1
    assert {"flip", "hdr_flip", "rel_mse", "rel_mse_trimmed", "mean_ratio"} <= set(measured)
    shown = capsys.readouterr()
    assert "HDR-FLIP" in shown.out and shown.err == ""


def test_structures_are_benchmarked(tmp_path: Path, capsys: Capture) -> None:
    path = tmp_path / "b.json"
    words = ["bench", "structures", "--scene", "builtin:cornell", "--count", "100"]
    assert run([*words, "--rounds", "1", "--json", str(path)]) == 0
    assert json.loads(path.read_text())["results"]
    assert "embree" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (["--rays", "purple"], "error: rays: "),
        (["--count", "0"], "error: count: "),
        (["--structures", "quadtree"], "error: structures: unknown structure 'quadtree'"),
        (["--structures", "bvh,bvh"], "error: structures: "),
        (["--trees", "two"], "error: trees: "),
        (["-o", "figures.xls"], "error: --output: must end in .json .csv .md"),
        (["--chart", "chart.gif"], "error: --chart: must end in .svg .png"),
        (["--heat-map", "nowhere/costs.png"], "error: --heat-map: there is no folder"),
        (["--count", "20000000"], "error: count: must be at most 10,000,000"),
        (["--structures", "brute", "--count", "2000000"], "error: structures: brute tests"),
        (["--structures", "embree", "--heat-map", "costs.png"], "error: --heat-map: no structure"),
        (["--set", "bounces=2"], "error: --set: needs --pictures"),
        (["-e", "builtin:studio"], "error: --environment: needs --pictures"),
        (["--samples", "4"], "error: --samples: needs --pictures"),
        (["--probe-at", "0,0,0"], "error: --probe-at: needs --pictures"),
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
    assert run(["compare", "builtin:cornell", "--rounds", "1", *words]) == 2
    shown = capsys.readouterr()
    assert shown.err.startswith(complaint)
    assert shown.err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_frames_are_benchmarked(tmp_path: Path, capsys: Capture) -> None:
    figures, chart = tmp_path / "f.json", tmp_path / "c.svg"
    words = ["bench", "frame", "--scene", "builtin:cornell", "--size", "16x12", "--rounds", "1"]
    words += ["--series", "stages,resolution", "--set", "occlusion_samples=1"]
    assert run([*words, "--json", str(figures), "--chart", str(chart)]) == 0
    measured = json.loads(figures.read_text())
    assert {"machine", "version", "results"} <= set(measured)
    assert [(r["series"], r["width"]) for r in measured["results"]] == [
        ("stages", 16),
        *(("resolution", width) for width in (4, 8, 12, 16, 24)),
    ]
    assert "<svg" in chart.read_text()
    shown = capsys.readouterr()
    assert "24x18" in shown.out and "rasterise" in shown.out and "shadow rays" in shown.out
    assert shown.err == ""


def test_summed_area_tables_are_benchmarked(tmp_path: Path, capsys: Capture) -> None:
    path = tmp_path / "s.json"
    words = ["bench", "sat", "--size", "16x12", "--rounds", "1", "--json", str(path)]
    assert run([*words, "--directions", "4", "-e", "builtin:gradient"]) == 0
    measured = json.loads(path.read_text())
    assert {"machine", "version", "results"} <= set(measured)
    kinds = {r["measured"] for r in measured["results"]}
    assert kinds == {"build", "lookup", "light", "error"}
    tables = [r for r in measured["results"] if r["measured"] in ("build", "lookup")]
    assert {(r["width"], r["height"]) for r in tables} == {(16, 12)}
    maps = {r["map"] for r in measured["results"] if r["measured"] == "error"}
    assert maps == {"builtin:gradient"}
    shown = capsys.readouterr()
    assert "doubling" in shown.out and "mlookups_per_s" in shown.out
    assert shown.err == ""


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (["sat", "--size", "wide"], "error: --size: "),
        (["sat", "--size", "0x5"], "error: size: must be at least 1x1"),
        (["sat", "--size", "99999x99999"], "error: size: may have 33,554,432 texels"),
        (["sat", "--json", "nowhere/f.json"], "error: --json: there is no folder"),
        (["smell"], "error: No such command 'smell'"),
        (["frame", "--series", "weather"], "error: series: unknown 'weather'"),
        (["frame", "--set", "bounces=9"], "error: settings.bounces: "),
        (["frame", "--size", "wide"], "error: --size: "),
        (["frame", "--chart", "c.gif"], "error: --chart: must end in .svg .png"),
        (["frame", "--json", "nowhere/f.json"], "error: --json: there is no folder"),
        (["frame", "--count", "5"], "error: No such option: --count"),
    ],
)
def test_wrong_words_for_a_benchmark_are_refused(
    words: list[str],
    complaint: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: Capture,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(["bench", *words]) == 2
    assert capsys.readouterr().err.startswith(complaint)
    assert list(tmp_path.iterdir()) == []


def test_benchmarks_are_listed(capsys: Capture) -> None:
    assert run(["bench"]) == 2
    shown = capsys.readouterr()
    assert all(name in shown.out for name in ("structures", "frame", "sat"))
