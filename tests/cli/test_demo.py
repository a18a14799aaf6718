"""The demonstration: a service in a process of its own, asked over HTTP."""

import json
import socket
from pathlib import Path

import pytest
from PIL import Image

from raysvc.cli.app import run


@pytest.mark.slow
def test_the_demo_leaves_pictures_and_timings(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "demo"
    assert run(["demo", "-o", str(folder), "--scene", "cornell", "--size", "32x18"]) == 0
    with Image.open(folder / "picture.png") as image:
        assert image.size == (32, 18)
    assert (folder / "picture.exr").read_bytes().startswith(b"\x76\x2f\x31\x01")
    assert json.loads((folder / "stats.json").read_text())["width"] == 32
    shown = capsys.readouterr()
    assert "total" in shown.out


def test_a_port_that_is_taken_is_said_in_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        assert run(["serve", "--port", str(port)]) == 1
    assert capsys.readouterr().err == f"error: 127.0.0.1:{port}: Address already in use\n"
