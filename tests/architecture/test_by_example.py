"""docs/by_example.md: every route is there, and curl and Python do as the page says."""

import re
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from api.access import SCOPES
from api.app import create_app
from api.settings import ApiSettings
from tests.live import listening

PAGE = (Path(__file__).parents[2] / "docs" / "by_example.md").read_text(encoding="utf-8")
ADDRESS = "http://127.0.0.1:8000"

OBJ = "mtllib cottage.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl wall\nf 1 2 3 4\n"
PAGES_FOR_PEOPLE = {("GET", "/"), ("GET", "/docs")}


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where the examples are run: with the files that they send."""
    (tmp_path / "cottage.obj").write_text(OBJ)
    (tmp_path / "cottage.mtl").write_text("newmtl wall\nKd 1 0.5 0.2\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def service(folder: Path) -> Iterator[str]:
    with listening(create_app(ApiSettings(data_dir=folder / "data"))) as url:
        yield url


def test_every_route_has_a_place_on_the_page() -> None:
    told = set(re.findall(r"`([A-Z]+) (/\S*)`", PAGE))
    assert told == set(SCOPES) - PAGES_FOR_PEOPLE


def test_every_part_shows_both() -> None:
    parts = PAGE.split("\n## ")[1:]
    assert len(parts) >= 7
    for part in parts:
        assert "```sh\n" in part, part[:40]
        assert "```python\n" in part, part[:40]


def test_the_python_examples_run_in_order(service: str) -> None:
    scope: dict[str, object] = {}
    for example in blocks("python"):
        exec(compile(example.replace(ADDRESS, service), "by_example.md", "exec"), scope)
    assert bytes(scope["picture"]).startswith(b"\x89PNG")  # type: ignore[call-overload]
    assert bytes(scope["soft"]).startswith(b"\x89PNG")  # type: ignore[call-overload]
    assert bytes(scope["heat_map"]).startswith(b"\x89PNG")  # type: ignore[call-overload]


@pytest.mark.skipif(shutil.which("curl") is None, reason="there is no curl")
def test_the_curl_examples_run_in_order(service: str, folder: Path) -> None:
    """Ids of answers are what `$SCENE`, `$RENDER` and so on stand for."""
    named: dict[str, str] = {}
    exr = ["curl", "-s", f"{service}/v1/render?format=exr", "-F", "scene=builtin:cornell"]
    exr += ["-F", 'camera={"width": 16, "height": 9}', "-o", "sharp.exr"]
    subprocess.run(exr, check=True)
    covered = set()
    for command in commands():
        url = re.search(rf"{ADDRESS}(/[^\s\"?]*)", command)
        assert url is not None
        method = "DELETE" if "-X DELETE" in command else "PUT" if " -T " in command else None
        sends = re.search(r" (-d|-F) ", command)
        route = re.sub(r"\.(csv|md|svg|png|exr)$", ".{format}", re.sub(r"\$[A-Z]+", "{id}", url[1]))
        covered.add((method or ("POST" if sends else "GET"), route))
        shown = command.replace(ADDRESS, service).replace("curl -s", "curl -sS --fail-with-body")
        for name, value in named.items():
            shown = shown.replace(f"${name}", value)
        done = subprocess.run(["sh", "-c", shown], capture_output=True, text=True, check=False)
        assert done.returncode == 0, f"{shown}\n{done.stdout[:500]}{done.stderr}"
        found = re.match(r'\{"id":"(\w+)"', done.stdout)
        kind = url[1].split("/")[2].rstrip("s").upper() if url[1].count("/") > 1 else ""
        if found and sends:
            named[kind] = found[1]
    assert covered == set(SCOPES) - PAGES_FOR_PEOPLE
    for name in ("cornell.webp", "depth.exr", "cottage.png", "soft.png", "chart.svg", "studio.exr"):
        assert (folder / name).stat().st_size > 100, name


def commands() -> Iterator[str]:
    for block in blocks("sh"):
        yield from block.replace("\\\n", " ").strip().splitlines()
