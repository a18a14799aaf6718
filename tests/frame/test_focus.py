"""Focus on a pixel: what it shows is sharp."""

import numpy as np
import pytest

import raysvc
from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import sheet
from raysvc.errors import InvalidSetting
from raysvc.scene import Material
from tests.frame.subjects import GREY, VIEW, still_life

LENS = VIEW | {"aperture_radius": 0.1}


@pytest.mark.parametrize("place", [[30, 30], [60.9, 25.2], [0, 53.99]])
def test_what_the_pixel_shows_has_no_blur(place) -> None:
    frame = raysvc.render(still_life(), camera=LENS | {"focus_pixel": place})
    coc = frame.layers["coc"]
    assert abs(coc[int(place[1]), int(place[0])]) < 1e-3
    assert np.abs(coc).max() > 1


def test_both_modes_agree_and_it_is_the_focus_distance_of_that_depth() -> None:
    settings = {"mode": "reference", "samples": 4}
    depth = float(raysvc.render(still_life(), camera=LENS).layers["depth"][30, 30])
    by_pixel = raysvc.render(still_life(), camera=LENS | {"focus_pixel": [30, 30]})
    by_depth = raysvc.render(still_life(), camera=LENS | {"focus_distance": depth})
    by_paths = raysvc.render(
        still_life(), camera=LENS | {"focus_pixel": [30, 30]}, settings=settings
    )
    assert np.allclose(by_pixel.layers["coc"], by_depth.layers["coc"], atol=1e-3)
    assert np.array_equal(by_pixel.layers["coc"], by_paths.layers["coc"])


def test_a_pane_that_covers_little_is_looked_through() -> None:
    pane = Material("pane", base_colour=(1.0, 1.0, 1.0, 0.2), alpha_mode="blend", double_sided=True)
    upright = sheet(4.0, 4.0, 1, 1).turned(90, 0)
    parts = [Part(upright.moved([0, 0, 0]), 0), Part(upright.moved([0, 0, 2.0]), 1)]
    scene = scene_of("pane", parts, [GREY, pane])
    view = {"eye": [0, 0, 5], "target": [0, 0, 0], "width": 32, "height": 18}
    frame = raysvc.render(scene, camera=view | {"aperture_radius": 0.1, "focus_pixel": [16, 9]})
    assert frame.layers["depth"][9, 16] == pytest.approx(5.0, rel=1e-5)
    assert abs(frame.layers["coc"][9, 16]) < 1e-3


@pytest.mark.parametrize(
    ("view", "reason"),
    [
        ({"focus_pixel": [96, 3]}, "less than width 96"),
        ({"focus_pixel": [3, 54]}, "less than height 54"),
        ({"focus_pixel": [-1, 3]}, "greater than or equal to 0"),
        ({"focus_pixel": [1, 3], "focus_distance": 2.0}, "together with focus_pixel"),
        ({"focus_pixel": [1, 3], "focus_point": [0, 0, 0]}, "together with focus_pixel"),
        ({"focus_pixel": [50, 0]}, "shows nothing"),
    ],
)
def test_a_pixel_that_cannot_be_in_focus_is_refused_by_name(view, reason) -> None:
    with pytest.raises(InvalidSetting, match=reason) as caught:
        raysvc.render(still_life(), camera=VIEW | view)
    assert caught.value.field.startswith("camera.focus_")
