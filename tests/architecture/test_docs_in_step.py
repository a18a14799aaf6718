"""What callers can say is documented, or these tests fail."""

import re
from collections.abc import Iterable
from pathlib import Path

import pytest
import typer
from fastapi.testclient import TestClient
from pydantic_settings import BaseSettings

from api.access import SCOPES
from api.app import create_app
from api.described_settings import described, shown
from api.filter_schemas import FilteredBody
from api.limit_settings import LimitSettings
from api.problems import PROBLEMS
from api.settings import ApiSettings
from raysvc.cli.app import app as command_line
from raysvc.frame.probe import Probe
from raysvc.frame.settings import Settings
from raysvc.frame.view import View
from raysvc.jobs import PatternRenderer

DOCS = Path(__file__).parents[2] / "docs"
HTTP = (DOCS / "http.md").read_text(encoding="utf-8")
LIMITS = (DOCS / "limits.md").read_text(encoding="utf-8")
RUNNING = (DOCS / "running.md").read_text(encoding="utf-8")
COMMAND_LINE = (DOCS / "command_line.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", [*Settings.model_fields, *View.model_fields, *Probe.model_fields])
def test_every_camera_probe_and_setting_field_is_documented(name: str) -> None:
    assert f"| `{name}` |" in HTTP


@pytest.mark.parametrize("name", FilteredBody.model_fields)
def test_every_field_of_a_filtering_is_documented(name: str) -> None:
    section = HTTP.partition("### Filtering an environment")[2].partition("\n### ")[0]
    assert f"| `{name}` |" in section


def rows_of(settings: BaseSettings, but_for: Iterable[str] = ()) -> list[str]:
    """The table of some settings as it should be."""
    left_out = {f"RAYSVC_{name.upper()}" for name in but_for}
    rows = []
    for setting in described(settings):
        default = shown(setting.name, setting.default)
        if setting.name == "RAYSVC_DATA_DIR":  # another one for each user
            default = "the user's data folder"
        if setting.name not in left_out:
            rows.append(f"| `{setting.name}` | {default} | {setting.meaning} |")
    return rows


def told_rows(page: str) -> list[str]:
    return [line for line in page.splitlines() if line.startswith("| `RAYSVC_")]


def test_the_tables_of_settings_are_what_the_settings_say(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ApiSettings.model_fields:
        monkeypatch.delenv(f"RAYSVC_{name.upper()}", raising=False)
    assert told_rows(LIMITS) == rows_of(LimitSettings())
    assert told_rows(HTTP) == rows_of(ApiSettings(), LimitSettings.model_fields)


def test_every_route_is_documented(tmp_path: Path) -> None:
    schema = create_app(ApiSettings(data_dir=tmp_path)).openapi()
    missing = [
        f"{method.upper()} {path}"
        for path, methods in schema["paths"].items()
        for method in methods
        if f"`{method.upper()} {path}`" not in HTTP
    ]
    assert not missing


@pytest.mark.parametrize("problem", PROBLEMS.values(), ids=lambda problem: problem.type)
def test_every_kind_of_problem_is_documented(problem: object) -> None:
    assert f"| `{problem.type}` | {int(problem.status)} |" in HTTP  # type: ignore[attr-defined]


def test_the_scope_of_every_route_is_documented() -> None:
    rows = dict(re.findall(r"^\| (`\w+`|none) \| (`[A-Z]+ /.*) \|$", RUNNING, re.MULTILINE))
    told = {
        tuple(route.split()): None if scope == "none" else scope.strip("`")
        for scope, cell in rows.items()
        for route in re.findall(r"`([A-Z]+ \S+)`", cell)
    }
    assert told == {route: scope and str(scope) for route, scope in SCOPES.items()}


def test_every_metric_is_documented(tmp_path: Path) -> None:
    with TestClient(create_app(ApiSettings(data_dir=tmp_path), pattern_renderer)) as client:
        text = client.get("/metrics").text
    names = re.findall(r"^# TYPE (\S+)", text, re.MULTILINE)
    told = re.findall(r"^\| `(raysvc_\w+)` \|", RUNNING, re.MULTILINE)
    assert sorted(told) == sorted(names)


def pattern_renderer(*_: object) -> PatternRenderer:
    return PatternRenderer()


def commands() -> dict[str, typer.core.TyperCommand]:
    """Every command by its words: `render`, `bench frame`."""
    found: dict[str, typer.core.TyperCommand] = {}
    groups = {"": typer.main.get_command(command_line)}
    while groups:
        words, group = groups.popitem()
        for name, command in group.commands.items():  # type: ignore[attr-defined]
            holds = groups if hasattr(command, "commands") else found
            holds[f"{words} {name}".strip()] = command
    return found


@pytest.mark.parametrize("name", sorted(commands()))
def test_every_command_is_documented_with_its_options(name: str) -> None:
    heading = f"## raysvc {name}\n"
    assert heading in COMMAND_LINE
    section = COMMAND_LINE.partition(heading)[2].partition("\n## ")[0]
    for parameter in commands()[name].params:
        for option in parameter.opts + parameter.secondary_opts:
            if option.startswith("-"):
                assert f"`{option}" in section, option


def test_links_between_pages_lead_somewhere() -> None:
    for page in DOCS.glob("*.md"):
        for target in re.findall(r"\]\(([^)#:]+)\)", page.read_text(encoding="utf-8")):
            assert (DOCS / target).exists(), f"{page.name}: {target}"
