from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from api.json_bodies import parse_object
from api.problems import MalformedBody


def test_plain_objects_are_read() -> None:
    assert parse_object(b'{"a": [1, 2.5, {"b": null}]}', "body") == {"a": [1, 2.5, {"b": None}]}


@pytest.mark.parametrize(
    ("text", "field"),
    [
        ('{"camera": {"eye": [0, NaN, 0]}}', "camera.eye.1"),
        ('{"settings": {"exposure_stops": -Infinity}}', "settings.exposure_stops"),
        ('{"camera": {"fov_y_deg": 1e999}}', "camera.fov_y_deg"),
        ('{"scene": "\\ud800"}', "scene"),
        ('{"\\udfff": 1}', "body"),
        ('{"a": 1, "a": 2}', "body"),
        ('{"a": 1' + "0" * 5000 + "}", "body"),
        ('{"a":' + "[" * 40 + "]" * 40 + "}", "body"),
        ("[" * 100_000, "body"),
        ("null", "body"),
        ('{"a": 1} 2', "body"),
    ],
)
def test_what_is_not_strict_json_is_refused_by_name(text: str, field: str) -> None:
    with pytest.raises(MalformedBody) as raised:
        parse_object(text, "body")
    assert raised.value.field == field


def test_a_part_of_a_form_is_named_after_its_field() -> None:
    with pytest.raises(MalformedBody) as raised:
        parse_object('{"eye": [NaN]}', "camera")
    assert raised.value.field == "camera.eye.0"


@given(st.binary(max_size=60) | st.text(alphabet='{}[]",:0189eE+-.\\u null', max_size=60))
def test_nothing_else_is_ever_raised(text: Any) -> None:
    try:
        assert isinstance(parse_object(text, "body"), dict)
    except MalformedBody as error:
        assert error.field is not None
