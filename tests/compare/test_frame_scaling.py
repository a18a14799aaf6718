import dataclasses
import io
import json

import numpy as np
import pytest
from PIL import Image

import raysvc
from raysvc.compare import frame_scaling
from raysvc.compare.frame_charts import frame_chart
from raysvc.compare.frame_scaling import BOUNCES, SERIES, bench_frame
from raysvc.errors import Cancelled, InvalidSetting, LimitExceeded
from raysvc.frame.settings import Settings
from raysvc.frame.view import View
from raysvc.parallel import Control

PROMISED = "scene width height settings seconds stages".split()
VIEW = View(width=16, height=12)
QUICK = Settings(occlusion_samples=1, aa="none")


@pytest.fixture(scope="module")
def cornell():
    return raysvc.load("builtin:cornell")


@pytest.fixture(scope="module")
def measured(cornell):
    return bench_frame({"box": cornell}, SERIES, VIEW, QUICK, rounds=2, control=Control(3))


def points(measured, series):
    return [result for result in measured["results"] if result["series"] == series]


def test_results_have_the_names_that_readers_were_promised(measured):
    assert {"machine", "version", "results"} <= set(measured)
    for result in measured["results"]:
        assert set(PROMISED) <= set(result)
        assert result["scene"] == "box" and result["seconds"] > 0 and result["iqr"] >= 0
        assert Settings(**result["settings"]).occlusion_samples == 1
    json.dumps(measured, allow_nan=False)


def test_stages_are_those_of_a_frame_and_take_about_what_it_takes(measured, cornell):
    frame = raysvc.render(cornell, camera={"width": 8, "height": 8})
    names = [stage.name for stage in frame.statistics.stages]
    for result in measured["results"]:
        assert [stage["name"] for stage in result["stages"]] == names
        assert sum(stage["seconds"] for stage in result["stages"]) < 2 * result["seconds"]


def test_every_series_varies_one_thing(measured, cornell):
    count = len(cornell.triangles)
    varied = {
        "stages": [(16, 12, count, None, 3)],
        "bounces": [(16, 12, count, bounces, 3) for bounces in BOUNCES],
        "resolution": [
            (width, height, count, None, 3)
            for width, height in ((4, 3), (8, 6), (12, 9), (16, 12), (24, 18))
        ],
        "triangles": [(16, 12, n * n * count, None, 3) for n in range(1, 9)],
        "threads": [(16, 12, count, None, threads) for threads in (1, 2, 3)],
    }
    assert set(varied) == set(SERIES)
    for series, expected in varied.items():
        found = [
            (r["width"], r["height"], r["triangles"], r["settings"]["bounces"], r["threads"])
            for r in points(measured, series)
        ]
        assert found == expected
    assert len(measured["results"]) == sum(map(len, varied.values()))


def test_points_are_called_by_what_is_varied(measured):
    assert [p["point"] for p in points(measured, "bounces")] == ["0", "1", "2", "3", "5", "8"]
    assert points(measured, "resolution")[0]["point"] == "4x3"
    assert points(measured, "threads")[-1]["point"] == "3"


def test_rays_are_those_of_one_frame(measured, cornell):
    view = {"gltf_camera": 0, "width": 16, "height": 12}
    once = raysvc.render(cornell, camera=view, settings=QUICK).statistics
    (frame,) = points(measured, "stages")
    assert frame["rays"] == once.rays
    assert frame["edge_fraction"] == once.edge_fraction == 0
    assert points(measured, "bounces")[0]["rays"] != frame["rays"]


def test_frames_of_a_series_take_turns_and_the_first_round_does_not_count(cornell, monkeypatch):
    seen = []

    def noted(scene, **asked):
        seen.append(asked["settings"].bounces)
        frame = raysvc.render(scene, **asked)
        taken = dataclasses.replace(frame.statistics, total_seconds=float(len(seen)))
        return dataclasses.replace(frame, statistics=taken)

    monkeypatch.setattr(frame_scaling, "render", noted)
    found = bench_frame({"box": cornell}, ["bounces"], VIEW, QUICK, rounds=3)["results"]
    assert seen == list(BOUNCES) * 4
    # Frame k was the (k + 1)th of each round of six, and the median is that of the third round.
    assert [point["seconds"] for point in found] == [13.0 + k for k in range(6)]
    assert [point["iqr"] for point in found] == [6.0] * 6


def test_triangles_are_cut_as_often_as_there_may_be(cornell, monkeypatch):
    monkeypatch.setattr(frame_scaling, "MOST_TRIANGLES", 10 * len(cornell.triangles))
    found = bench_frame({"box": cornell}, ["triangles"], VIEW, QUICK, rounds=1)["results"]
    parts = [point["triangles"] // len(cornell.triangles) for point in found]
    assert parts == [1, 4, 9]
    monkeypatch.setattr(frame_scaling, "MOST_TRIANGLES", 1)
    found = bench_frame({"box": cornell}, ["triangles"], VIEW, QUICK, rounds=1)["results"]
    assert [point["triangles"] for point in found] == [len(cornell.triangles)]


def test_as_many_threads_are_tried_as_the_settings_allow(cornell):
    few = QUICK.model_copy(update={"threads": 2})
    found = bench_frame({"box": cornell}, ["threads"], VIEW, few, 1, Control(5))["results"]
    assert [point["threads"] for point in found] == [1, 2]


def test_a_camera_that_was_asked_for_stays(cornell, monkeypatch):
    cameras = []

    def noted(scene, **asked):
        cameras.append(asked["camera"])
        return raysvc.render(scene, **asked)

    monkeypatch.setattr(frame_scaling, "render", noted)
    for view in (VIEW, View(eye=(0, 0, 3), width=8, height=8)):
        bench_frame({"box": cornell}, ["stages"], view, QUICK, rounds=1)
    assert [camera.gltf_camera for camera in cameras] == [0, 0, None, None]


def test_what_cannot_be_measured_is_refused_before_anything_is_rendered(cornell, monkeypatch):
    monkeypatch.setattr(frame_scaling, "render", None)
    with pytest.raises(InvalidSetting, match="unknown 'weather'"):
        bench_frame({"box": cornell}, ["stages", "weather"], VIEW, QUICK)
    with pytest.raises((InvalidSetting, LimitExceeded)):
        bench_frame({"box": cornell}, ["stages", "resolution"], View(width=15000, height=2), QUICK)


def test_a_benchmark_can_be_stopped(cornell):
    control = Control(1)
    control.cancel()
    with pytest.raises(Cancelled):
        bench_frame({"box": cornell}, ["bounces"], VIEW, QUICK, control=control)


def test_progress_goes_from_none_to_all_by_frames(cornell):
    heard = []
    control = Control(1, on_progress=lambda stage, part: heard.append((stage, part)))
    bench_frame({"box": cornell}, ["bounces"], VIEW, QUICK, rounds=2, control=control)
    assert [part for _, part in heard] == pytest.approx([k / 18 for k in range(18)])
    assert heard[1][0] == "bounces, 1"


@pytest.mark.parametrize("format", ["svg", "png"])
def test_a_chart_is_the_same_every_time(format, measured):
    some = {**measured, "results": points(measured, "stages") + points(measured, "resolution")}
    drawn = frame_chart(some, format)
    assert drawn == frame_chart(some, format)
    if format == "png":
        assert np.asarray(Image.open(io.BytesIO(drawn)).convert("L")).std() > 10
    else:
        assert b"million pixels" in drawn and b"dc:date" not in drawn


def test_a_chart_has_a_row_for_each_series_and_a_column_for_each_scene(measured):
    def size(results):
        drawn = frame_chart({**measured, "results": results}, "png")
        return np.array(Image.open(io.BytesIO(drawn)).size)

    bounces, threads = points(measured, "bounces"), points(measured, "threads")
    again = [{**result, "scene": "another"} for result in bounces]
    width, height = size(bounces)
    assert size(bounces + threads)[1] > 1.5 * height
    assert size(bounces + again)[0] > 1.3 * width
