"""Every number of a camera and of the settings at the ends of its range: a picture, or an error
that is the caller's."""

import math
import warnings
from collections.abc import Mapping
from typing import Any

import pytest

import raysvc
from raysvc.errors import RaysvcError
from raysvc.frame.settings import Settings
from raysvc.frame.view import View
from raysvc.parallel import Control

SCENE = raysvc.load("builtin:cornell")
SMALL = {"width": 16, "height": 9}
NOT_TRIED = {"width", "height", "samples", "threads", "deadline_s"}
"""What other tests look at."""
LEAST = 5e-324


def ends(schema: Mapping[str, Any]) -> list[float]:
    """The least and greatest numbers that a field takes."""
    found: list[float] = []
    for one in schema.get("anyOf", [schema]):
        if one.get("type") not in ("number", "integer"):
            continue
        if "exclusiveMinimum" in one:
            found.append(LEAST)
        if "exclusiveMaximum" in one and one["type"] == "number":
            found.append(math.nextafter(one["exclusiveMaximum"], 0))
        found += [one[name] for name in ("minimum", "maximum") if name in one]
    return found


def cases(model: type[View] | type[Settings]) -> list[tuple[str, float]]:
    fields = model.model_json_schema()["properties"]
    return [(n, end) for n, schema in fields.items() if n not in NOT_TRIED for end in ends(schema)]


def draw(camera: dict[str, Any], settings: dict[str, Any]) -> None:
    """Render; what is refused by name is as good as what is drawn."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # NumPy's, of what is beyond float32
        try:
            settings = {"occlusion_samples": 2, "samples": 1, **settings}
            raysvc.render(SCENE, None, {**SMALL, **camera}, settings, control=Control())
        except RaysvcError as error:
            assert error.field


@pytest.mark.parametrize(
    "others", [{}, {"focal_length_mm": 50.0}, {"aperture_radius": 0.1}], ids=str
)
@pytest.mark.parametrize(("name", "value"), cases(View))
def test_the_ends_of_a_cameras_numbers(name: str, value: float, others: dict[str, float]) -> None:
    draw({**others, name: value}, {})


@pytest.mark.parametrize("mode", ["hybrid", "reference"])
@pytest.mark.parametrize(("name", "value"), cases(Settings))
def test_the_ends_of_the_settings_numbers(name: str, value: float, mode: str) -> None:
    draw({"aperture_radius": 0.05}, {"mode": mode, name: value})


@pytest.mark.parametrize("name", ["eye", "target", "up", "focus_point"])
@pytest.mark.parametrize(
    "value", [(0, 0, 0), (1e9, -1e9, 1e9), (LEAST, 0, 0), (0, 1e9, 0)], ids=str
)
def test_places_far_and_near(name: str, value: tuple[float, float, float]) -> None:
    draw({name: value, "aperture_radius": 0.1}, {})


def test_a_lens_that_looks_at_nothing() -> None:
    camera = {"eye": (0, 1, 5), "target": (0, 1, 9), "aperture_radius": 0.1}
    frame = raysvc.render(SCENE, None, {**SMALL, **camera})
    assert not math.isfinite(frame.layers["depth"].min())
