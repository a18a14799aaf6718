"""`raysvc lens` on files."""

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from raysvc.cli.app import run
from raysvc.imaging.encode_layers import encode_exr
from tests.api.test_lens import sharp

LENS = ["--lens", "aperture_radius=0.4", "--lens", "fov_y_deg=40"]


@pytest.fixture
def exr(tmp_path: Path) -> Path:
    picture, depth = sharp()
    path = tmp_path / "sharp.exr"
    path.write_bytes(encode_exr({"beauty": picture, "depth": depth}))
    return path


def test_a_picture_of_raysvc_needs_no_other_file(exr: Path, tmp_path: Path) -> None:
    out, stats = tmp_path / "soft.npz", tmp_path / "stats.json"
    code = run(["lens", str(exr), "-o", str(out), *LENS, "--lens", "focus_distance=4.0",
                "--set", "aperture_blades=5", "--stats", str(stats)])  # fmt: skip
    assert code == 0
    with np.load(out) as layers:
        assert set(layers) == {"beauty", "depth", "coc"}
        assert 0.05 < layers["beauty"][12, 10, 0] < 0.95
        largest = float(np.abs(layers["coc"]).max())
    assert json.loads(stats.read_text())["max_coc_px"] == pytest.approx(largest)


def test_a_png_with_a_png_of_depth_and_a_camera_file(tmp_path: Path) -> None:
    picture, depth = sharp()
    Image.fromarray((picture * 255).astype(np.uint8)).save(tmp_path / "sharp.png")
    grey = np.where(np.isfinite(depth), depth * 100, 0).astype(np.uint16)
    Image.fromarray(grey).save(tmp_path / "depth.png")
    (tmp_path / "lens.json").write_text('{"aperture_radius": 0.2, "focus_distance": 2.0}')
    out = tmp_path / "soft.png"
    code = run(["lens", str(tmp_path / "sharp.png"), str(tmp_path / "depth.png"), "-o", str(out),
                "--depth-scale-m", "0.01", "--camera", str(tmp_path / "lens.json"),
                "--set", "tone_map=linear"])  # fmt: skip
    assert code == 0
    with Image.open(out) as shown:
        assert np.asarray(shown.convert("RGB"))[12, 16].tolist() == [255, 255, 255]


def test_what_is_missing_is_named(exr: Path, tmp_path: Path, capsys) -> None:
    out = str(tmp_path / "soft.png")
    Image.fromarray(np.zeros((4, 4, 3), np.uint8)).save(tmp_path / "sharp.png")
    assert run(["lens", str(tmp_path / "sharp.png"), "-o", out, *LENS]) == 2
    assert "DEPTH: is missing" in capsys.readouterr().err
    assert run(["lens", str(exr), "-o", out]) == 2
    assert "camera.aperture_radius" in capsys.readouterr().err
    assert run(["lens", str(exr), "-o", out, *LENS, "--set", "bounces=1"]) == 2
    assert "settings.bounces" in capsys.readouterr().err
    assert not Path(out).exists()
