"""Settings: checked by name, and every one of them does something."""

import numpy as np
import pytest

import raysvc
from raysvc.errors import InvalidSetting
from raysvc.frame.settings import Settings, settings_from
from tests.frame.subjects import VIEW, still_life


@pytest.mark.parametrize(
    ("values", "field"),
    [
        ({"bouncez": 1}, "settings.bouncez"),
        ({"bounces": 9}, "settings.bounces"),
        ({"bounces": -1}, "settings.bounces"),
        ({"lens": "scatter"}, "settings.lens"),
        ({"lens_order": 4}, "settings.lens_order"),
        ({"lens_layers": 0}, "settings.lens_layers"),
        ({"aperture_blades": 2}, "settings.aperture_blades"),
        ({"aperture_blades": 17}, "settings.aperture_blades"),
        ({"mode": "fast"}, "settings.mode"),
        ({"samples": 0}, "settings.samples"),
        ({"samples": 65537}, "settings.samples"),
        ({"exposure_stops": float("nan")}, "settings.exposure_stops"),
        ({"environment_strength": float("inf")}, "settings.environment_strength"),
        ({"background": [1.0, 2.0]}, "settings.background"),
        ({"background": "blue"}, "settings.background"),
        ({"threads": 0}, "settings.threads"),
        ({"occlusion_radius": 0}, "settings.occlusion_radius"),
    ],
)
def test_a_wrong_setting_is_refused_by_name(values: dict, field: str) -> None:
    with pytest.raises(InvalidSetting) as caught:
        settings_from(values)
    assert caught.value.field == field


@pytest.mark.parametrize("given", [5, [], ["bounces"], "bounces"])
def test_what_is_no_mapping_is_refused_by_name(given: object) -> None:
    with pytest.raises(InvalidSetting, match="settings: must be a mapping"):
        settings_from(given)  # type: ignore[arg-type]
    with pytest.raises(InvalidSetting, match="camera: must be a mapping"):
        raysvc.render(still_life(), camera=given)  # type: ignore[arg-type]


def test_every_default_is_what_the_specification_says_or_nearest_to_it() -> None:
    settings = Settings()
    assert (settings.mode, settings.samples) == ("hybrid", 64)
    assert (settings.occlusion_samples, settings.aa_samples) == (16, 8)
    assert (settings.bounce_limit, Settings(mode="reference").bounce_limit) == (3, 8)
    assert Settings(mode="reference", bounces=0).bounce_limit == 0
    assert (settings.aa, settings.lens, settings.ibl, settings.tone_map) == (
        "edges",
        "spread",
        "sat",
        "pbr_neutral",
    )


# What each setting changes in the still life. Settings with one value have nothing to change.
CHANGES: dict[str, object] = {
    "mode": "reference",
    "bounces": 0,
    "texture_filter": "nearest",
    "shadows": False,
    "occlusion_samples": 0,
    "occlusion_radius": 0.1,
    "ibl": "sh9",
    "ibl_order": 1,
    "ibl_lobe_samples": 1,
    "multiple_scattering": True,
    "lens": "none",
    "lens_shape": "box",
    "lens_order": 2,
    "lens_layers": 5,
    "aperture_blades": 3,
    "aa": "none",
    "aa_samples": 2,
    "environment_yaw_deg": 90.0,
    "environment_strength": 2.0,
    "background": [0.0, 0.0, 1.0],
    "seed": 7,
}
DISPLAYED: dict[str, object] = {"exposure_stops": 1.0, "tone_map": "linear"}
UNCHANGED: dict[str, object] = {
    "threads": 1,
    "structure": "embree",
    "trees": "per_material",
    "passes": "multi",
    "sat_builder": "doubling",
}
TESTED_ELSEWHERE = {"deadline_s", "samples", "lens_samples", "aperture_rotation_deg"}


def test_the_tables_name_every_setting() -> None:
    named = {*CHANGES, *DISPLAYED, *UNCHANGED} | TESTED_ELSEWHERE
    assert named == set(Settings.model_fields)


@pytest.fixture(scope="module")
def plain() -> raysvc.Frame:
    return raysvc.render(still_life(), camera=VIEW | {"aperture_radius": 0.1})


@pytest.mark.parametrize("name", CHANGES)
def test_a_setting_changes_the_picture(name: str, plain: raysvc.Frame) -> None:
    frame = raysvc.render(
        still_life(), camera=VIEW | {"aperture_radius": 0.1}, settings={name: CHANGES[name]}
    )
    assert not np.array_equal(frame.layers["beauty"], plain.layers["beauty"])
    assert np.isfinite(frame.layers["beauty"]).all()


@pytest.mark.parametrize("name", DISPLAYED)
def test_a_display_setting_changes_only_what_is_displayed(name: str, plain: raysvc.Frame) -> None:
    frame = raysvc.render(
        still_life(), camera=VIEW | {"aperture_radius": 0.1}, settings={name: DISPLAYED[name]}
    )
    assert np.array_equal(frame.layers["beauty"], plain.layers["beauty"])
    assert not np.array_equal(frame.display(), plain.display())


@pytest.mark.parametrize("name", UNCHANGED)
def test_how_the_work_is_done_changes_no_byte(name: str, plain: raysvc.Frame) -> None:
    frame = raysvc.render(
        still_life(), camera=VIEW | {"aperture_radius": 0.1}, settings={name: UNCHANGED[name]}
    )
    assert frame.encode("exr") == plain.encode("exr")
    if name == "sat_builder":
        assert frame.statistics.environment.builder == "doubling"
        assert frame.statistics.environment.passes > plain.statistics.environment.passes
    elif name not in ("trees", "passes"):
        assert getattr(frame.statistics, name) == UNCHANGED[name]
