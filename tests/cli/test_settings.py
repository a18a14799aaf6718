"""`raysvc settings`: every setting, its value, and where that is from."""

import json

import pytest

from api.settings import ApiSettings
from raysvc.cli.app import run


@pytest.fixture(autouse=True)
def _no_settings(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ApiSettings.model_fields:
        monkeypatch.delenv(f"RAYSVC_{name.upper()}", raising=False)


def found(capsys: pytest.CaptureFixture[str]) -> dict[str, dict[str, object]]:
    assert run(["settings", "--json"]) == 0
    return {setting["name"]: setting for setting in json.loads(capsys.readouterr().out)}


def test_every_setting_is_there(capsys: pytest.CaptureFixture[str]) -> None:
    settings = found(capsys)
    assert settings.keys() == {f"RAYSVC_{name.upper()}" for name in ApiSettings.model_fields}
    for setting in settings.values():
        assert setting.keys() == {"name", "value", "default", "meaning", "source"}
        assert setting["meaning"]
        assert setting["source"] == "default"
        assert setting["value"] == setting["default"]


def test_a_variable_changes_a_value(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RAYSVC_MAX_TRIANGLES", "7")
    settings = found(capsys)
    changed = settings.pop("RAYSVC_MAX_TRIANGLES")
    assert (changed["value"], changed["source"]) == (7, "environment")
    assert changed["default"] == 20_000_000
    assert {setting["source"] for setting in settings.values()} == {"default"}


def test_people_see_a_table(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RAYSVC_MAX_TRIANGLES", "1234567")
    assert run(["settings"]) == 0
    (row,) = [x for x in capsys.readouterr().out.splitlines() if "RAYSVC_MAX_TRIANGLES" in x]
    assert "1,234,567" in row and "20,000,000" in row and "environment" in row


def test_a_wrong_value_is_named(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RAYSVC_MAX_TRIANGLES", "few")
    assert run(["settings"]) == 2
    assert capsys.readouterr().err.startswith("error: RAYSVC_MAX_TRIANGLES: ")


@pytest.mark.parametrize(("name", "value"), [("RAYSVC_MAX_NODES", ""), ("raysvc_max_nodes", "7")])
def test_an_empty_variable_and_one_of_another_case_say_nothing(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, name: str, value: str
) -> None:
    monkeypatch.setenv(name, value)
    assert found(capsys)["RAYSVC_MAX_NODES"]["source"] == "default"
