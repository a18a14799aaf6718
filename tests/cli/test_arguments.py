from pathlib import Path

import pytest

from raysvc.cli.arguments import camera_mapping, checked_output, settings_mapping
from raysvc.errors import InvalidSetting


def test_values_are_json_where_they_can_be_and_else_texts() -> None:
    words = ["bounces=2", "shadows=false", "tone_map=agx", "background=[1, 0, 0.5]", "note=a=b"]
    assert settings_mapping(words) == {
        "bounces": 2,
        "shadows": False,
        "tone_map": "agx",
        "background": [1, 0, 0.5],
        "note": "a=b",
    }


@pytest.mark.parametrize("word", ["bounces", "=2", ""])
def test_a_word_that_sets_nothing_is_refused(word: str) -> None:
    with pytest.raises(InvalidSetting) as raised:
        settings_mapping([word])
    assert raised.value.field == "--set"


def test_setting_the_same_key_twice_is_refused() -> None:
    with pytest.raises(InvalidSetting) as raised:
        settings_mapping(["bounces=1", "bounces=2"])
    assert raised.value.field == "settings.bounces"


def test_the_size_overrides_the_camera_file(tmp_path: Path) -> None:
    path = tmp_path / "camera.json"
    path.write_text('{"eye": [1, 2, 3], "width": 5}')
    assert camera_mapping(path, "30x20") == {"eye": [1, 2, 3], "width": 30, "height": 20}
    assert camera_mapping(None, None) == {}


@pytest.mark.parametrize("size", ["30", "30x", "x20", "30X20", "-3x4", "3.5x4", "³x4"])
def test_a_size_is_two_whole_numbers(size: str) -> None:
    with pytest.raises(InvalidSetting) as raised:
        camera_mapping(None, size)
    assert raised.value.field == "--size"


@pytest.mark.parametrize("text", ["{", "[1]", "", "[" * 100_000])
def test_a_camera_file_holds_one_json_object(tmp_path: Path, text: str) -> None:
    path = tmp_path / "camera.json"
    path.write_text(text)
    with pytest.raises(InvalidSetting) as raised:
        camera_mapping(path, None)
    assert raised.value.field == "--camera"


@pytest.mark.parametrize("name", ["picture", "picture.gif", "nowhere/picture.png"])
def test_an_output_that_cannot_be_written_is_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(InvalidSetting):
        checked_output(tmp_path / name)
