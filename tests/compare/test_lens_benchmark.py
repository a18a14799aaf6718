"""The benchmark of the lens: every figure is there, and the truth is one."""

import numpy as np
import pytest

import raysvc
from raysvc.compare.lens_benchmark import DIAMETERS_PX, LensSubject, bench_lens, ramp
from raysvc.compare.lens_subjects import lens_subjects
from tests.frame.subjects import constant_environment, still_life


def test_costs_of_every_bokeh_and_size_are_there():
    measured = bench_lens({}, 0, size=(64, 36), rounds=2)
    found = [(r["max_coc_px"], r["shape"], r["order"]) for r in measured["results"]]
    shapes = [("box", 1), ("box", 2), ("box", 3), ("disc", 1), ("6 blades", 1), ("gather", 1)]
    assert found == [(d, *shape) for d in DIAMETERS_PX for shape in shapes]
    assert all(r["seconds"] > 0 and r["layers"] in (0, 4) for r in measured["results"])
    assert measured["truth"] == []


def test_a_ramp_goes_from_before_the_focus_to_behind():
    line = ramp(16.0, 33, 5)
    assert line.shape == (5, 33)
    assert (line[0, 0], line[0, 16], line[0, -1]) == (-16, 0, 16)


def test_the_truth_tells_spreading_from_gathering():
    view = raysvc.View(
        eye=(0.5, 2.0, 5.0), target=(0.0, 0.6, 0.0), width=96, height=54, aperture_radius=0.25
    )
    subject = LensSubject(still_life(), view, constant_environment())
    shown = {}
    truth = bench_lens({"still": subject}, 64, size=(16, 9), rounds=1, show=shown.__setitem__)[
        "truth"
    ]
    for against, lenses in (
        ("accumulated", ["none", "gather", "spread", "fine", "alone"]),
        ("reference", ["none", "gather", "spread", "fine"]),
    ):
        by_lens = {each["lens"]: each for each in truth if each["against"] == against}
        assert list(by_lens) == lenses
        assert by_lens["none"]["max_coc_px"] == 0 < by_lens["spread"]["max_coc_px"]
        for lens in lenses[2:]:
            assert by_lens[lens]["flip"] < by_lens["gather"]["flip"]
            assert by_lens[lens]["ssim"] > by_lens["gather"]["ssim"]
        spread = shown[f"still_spread_{against}"].flip_map
        assert np.mean(spread) == pytest.approx(by_lens["spread"]["flip"])
    assert len(shown) == len(truth) == 9


def test_subjects_have_blur_before_and_behind():
    light = constant_environment()
    subjects = lens_subjects({"width": 64, "height": 36}, "builtin:torus_park", light)
    lit = ["shiny_near_lit", "shiny_far_lit", "file"]
    assert list(subjects) == ["shiny_near", "shiny_far", "fence", *lit]
    assert all(subjects[name].environment is light for name in lit)
    for name, sign in (("shiny_near", -1), ("shiny_far", 1), ("fence", -1)):
        subject = subjects[name]
        frame = raysvc.render(
            subject.scene, subject.environment, subject.view, {"occlusion_samples": 0, "bounces": 0}
        )
        # Of 64 pixels' width: a tenth of what it is on 640.
        assert (sign * frame.layers["coc"]).max() > 0.8, name
