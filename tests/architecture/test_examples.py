"""The Python examples of README.md and docs/ run as they are written."""

import re
from pathlib import Path

import httpx
import pytest
from fastapi import FastAPI
from fastapi.testclient import TestClient

from api.app import create_app
from api.settings import ApiSettings

ROOT = Path(__file__).resolve().parents[2]


def examples(page: str) -> list[str]:
    return re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(encoding="utf-8"), re.DOTALL)


def service_in(folder: Path) -> FastAPI:
    """What the examples talk to, instead of a service that somebody started."""
    return create_app(ApiSettings(data_dir=folder / "data"))


@pytest.mark.parametrize(
    "page",
    [
        "README.md",
        "docs/python.md",
        "docs/comparing_structures.md",
        "docs/comparing_pictures.md",
        "docs/deforming.md",
        "docs/summed_area_tables.md",
        "docs/texture_filtering.md",
    ],
)
def test_examples_run(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(httpx, "Client", lambda base_url: TestClient(service_in(tmp_path)))
    found = examples(page)
    assert found
    scope: dict[str, object] = {}
    for example in found:
        # Small pictures: what is tested is that the names and calls are right.
        small = example.replace('"width": 800, "height": 450', '"width": 80, "height": 45')
        small = small.replace('"width": 240, "height": 135', '"width": 24, "height": 14')
        small = small.replace("FRAMES = 8", "FRAMES = 2").replace("range(24)", "range(2)")
        small = small.replace('open("shiny.exr", "wb").write(', "len(")
        exec(compile(small, page, "exec"), scope)


def test_links_of_the_pages_lead_somewhere() -> None:
    pages = [ROOT / "README.md", *(ROOT / "docs").glob("*.md")]
    for page in pages:
        for target in re.findall(r"\]\(([^)#]+)\)", page.read_text(encoding="utf-8")):
            assert (page.parent / target).exists(), f"{page.name}: {target}"


def test_every_public_name_is_described() -> None:
    import raysvc

    text = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    for name in set(raysvc.__all__) - {"__version__"}:
        assert f"| `{name}" in text, name
