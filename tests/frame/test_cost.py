"""The estimate of a picture's cost: it grows with what is asked for, is not far from the truth, and
refuses by name."""

import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

import raysvc
from raysvc.errors import LimitExceeded
from raysvc.frame.cost import check_estimate, estimated_core_s
from raysvc.frame.settings import Settings, settings_from
from raysvc.frame.view import View, camera_from
from raysvc.limits import Limits
from raysvc.scene import Camera, Scene

CORNELL = raysvc.load("builtin:cornell")
OFF_BY = 5.0

MOST = {
    "samples": 65536,
    "bounces": 8,
    "occlusion_samples": 256,
    "aa_samples": 64,
    "lens_samples": 65536,
}
SETTINGS = st.fixed_dictionaries(
    {
        "mode": st.sampled_from(["hybrid", "reference"]),
        "samples": st.integers(1, 65536),
        "bounces": st.integers(0, 8),
        "occlusion_samples": st.integers(0, 256),
        "aa": st.sampled_from(["none", "edges", "full", "directional", "accumulate"]),
        "aa_samples": st.integers(1, 64),
        "lens": st.sampled_from(["spread", "accumulate"]),
        "lens_samples": st.integers(1, 65536),
        "ibl": st.sampled_from(["sat", "brute"]),
        "shadows": st.booleans(),
    }
)


def seen(width: int, height: int) -> Camera:
    """The default view, through a lens."""
    return camera_from(View(width=width, height=height, aperture_radius=0.1), CORNELL)


@given(SETTINGS, st.integers(1, 4096), st.integers(1, 4096), st.data())
def test_who_asks_for_more_pays_no_less(
    values: dict[str, object], width: int, height: int, data: st.DataObject
) -> None:
    asked, camera = settings_from(values), seen(width, height)
    cost = estimated_core_s(asked, camera, CORNELL)
    assert 0 < cost < 1e12
    assert estimated_core_s(asked, seen(width + 1, height), CORNELL) > cost
    for name, most in MOST.items():
        more = data.draw(st.integers(values[name], most))  # type: ignore[arg-type]
        assert estimated_core_s(settings_from({**values, name: more}), camera, CORNELL) >= cost


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("cornell", {}),
        ("cornell", {"mode": "reference", "samples": 16}),
        ("shiny", {"aa": "full"}),
        ("shiny", {"bounces": 8, "aa": "none", "occlusion_samples": 0}),
        ("glass", {"aa": "none"}),
        ("fence", {}),
        ("cornell", {"aa": "accumulate", "aa_samples": 8}),
        ("fence", {"lens": "accumulate", "lens_samples": 8}),
        ("torus_park", {"mode": "reference", "samples": 8}),
    ],
)
def test_the_estimate_is_not_far_from_the_truth(name: str, settings: dict[str, object]) -> None:
    scene = raysvc.load(f"builtin:{name}")
    through_a_lens = {"aperture_radius": 0.05} if "lens" in settings else {}
    camera = View(width=320, height=180, **through_a_lens)  # type: ignore[arg-type]
    asked = settings_from({"threads": 1, **settings})
    raysvc.render(scene, camera=View(width=32, height=18), settings=asked)  # build trees, compile
    began = time.process_time()
    raysvc.render(scene, camera=camera, settings=asked)
    took = time.process_time() - began
    estimate = estimated_core_s(asked, camera_from(camera, scene), scene)
    print(name, settings, round(took, 2), round(estimate, 2))  # noqa: T201
    assert took / OFF_BY < estimate < took * OFF_BY


def refused(values: dict[str, object], most: float, scene: Scene = CORNELL) -> LimitExceeded:
    camera = camera_from(View(width=1000, height=1000, aperture_radius=0.1), scene)
    with pytest.raises(LimitExceeded) as error:
        check_estimate(settings_from(values), camera, scene, Limits(max_render_core_s=most))
    return error.value


@pytest.mark.parametrize(
    ("values", "most", "field"),
    [
        ({"mode": "reference", "samples": 1000}, 100.0, "settings.samples"),
        ({"aa": "full", "aa_samples": 64}, 100.0, "settings.aa_samples"),
        ({"ibl": "brute"}, 100.0, "settings.ibl"),
        ({"aa": "accumulate", "aa_samples": 64}, 100.0, "settings.aa_samples"),
        ({"lens": "accumulate", "lens_samples": 4096}, 100.0, "settings.lens_samples"),
        ({"occlusion_samples": 256, "aa": "none"}, 20.0, "settings.occlusion_samples"),
        ({"aa": "none", "occlusion_samples": 0}, 1.0, "camera.width"),
    ],
)
def test_a_picture_that_costs_too_much_is_refused_by_name(
    values: dict[str, object], most: float, field: str
) -> None:
    error = refused(values, most)
    assert error.field == field
    assert "RAYSVC_MAX_RENDER_CORE_S" in error.message
    assert f"{most:g}" in error.message


def test_bounces_are_named_where_rays_branch() -> None:
    scene = raysvc.load("builtin:glass")
    assert refused({"bounces": 8, "aa": "none"}, 100.0, scene).field == "settings.bounces"


def test_what_costs_little_enough_passes() -> None:
    camera = camera_from(View(), CORNELL)
    check_estimate(Settings(), camera, CORNELL, Limits())
    check_estimate(Settings(mode="reference", samples=256), camera, CORNELL, Limits())
