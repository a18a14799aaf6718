"""Tables, charts and heat maps of one small comparison."""

import csv
import dataclasses
import io
import json

import numpy as np
import OpenEXR
import pytest
from PIL import Image

import raysvc
from raysvc.compare.charts import chart
from raysvc.compare.compare import compare
from raysvc.compare.contenders import contender
from raysvc.compare.heat_map import HeatMap, heat_map
from raysvc.compare.heat_map_files import heat_maps_exr, heat_maps_png
from raysvc.compare.settings import Candidate
from raysvc.compare.tables import BUILD, TRAVERSAL, table
from raysvc.compare.talk_2009 import SCENE, TALK, talk_beside
from raysvc.frame.view import View, camera_from
from raysvc.parallel import Control

VIEW = {"gltf_camera": 0, "width": 40, "height": 30}


@pytest.fixture(scope="module")
def measured():
    return compare(
        raysvc.load("builtin:cornell"),
        {
            "count": 300,
            "rounds": 2,
            "builds": 1,
            "structures": ("embree", "bvh", "kd"),
            "trees": "both",
            "camera": VIEW,
            "heat_map": True,
            "scaling": True,
        },
        source="builtin:cornell",
    )


@pytest.fixture(scope="module")
def beside_the_talk(measured):
    return dataclasses.replace(measured, talk_2009=TALK)


def sections(text):
    """Tables of a Markdown text by the heading above each: lists of lists of cells."""
    tables, heading = {}, ""
    for line in text.splitlines():
        if line.startswith("#"):
            heading = line.lstrip("# ")
        elif line.startswith("| "):
            cells = [cell.strip() for cell in line.strip("|").split("|")]
            tables.setdefault(heading, []).append(cells)
    return tables


def test_json_holds_everything(measured):
    assert json.loads(table(measured, "json")) == json.loads(json.dumps(measured.to_dict()))


def test_csv_has_a_row_for_each_structure_and_a_column_for_each_figure(measured):
    rows = list(csv.DictReader(io.StringIO(table(measured, "csv"))))
    assert [(row["name"], row["trees"]) for row in rows] == [
        (s.name, s.trees) for s in measured.structures
    ]
    assert {*BUILD, *TRAVERSAL, "rays", "count", "seed", "source"} <= set(rows[0])
    for row, structure in zip(rows, measured.structures, strict=True):
        assert float(row["build_ms"]) == structure.build.build_ms
        assert int(row["hits"]) == structure.traversal.hits
    embree = rows[0]
    assert embree["nodes"] == "" and embree["node_steps_per_ray"] == ""


def test_markdown_sets_structures_side_by_side(measured):
    tables = sections(table(measured, "md"))
    for heading, names in (("Build", BUILD), ("Traversal", TRAVERSAL)):
        head, _, *rows = tables[heading]
        assert len(head) == 1 + len(measured.structures)
        assert [row[0] for row in rows] == list(names)
        assert all(len(row) == len(head) for row in rows)
    assert tables["Build"][2][1] == "-"
    assert len(tables["Scaling with triangles"]) == 2 + 4 * len(measured.structures)


def test_the_talk_stands_beside_ours_row_by_row(beside_the_talk):
    text = table(beside_the_talk, "md")
    head, _, *rows = sections(text)["Beside the talk of 2009"]
    named = [row[0] for row in rows]
    assert named[:4] == ["bvh, talk of 2009", "bvh, here", "kd, talk of 2009", "kd, here"]
    assert named[4:] == ["bvh_stackless, talk of 2009", "bih, talk of 2009"]
    assert all(len(row) == len(head) for row in rows)
    for note in TALK.notes:
        assert note in text
    rows = list(csv.DictReader(io.StringIO(table(beside_the_talk, "csv"))))
    talk = {row["name"]: row for row in rows if row["source"] == "talk of 2009"}
    assert set(talk) == {"bvh", "kd", "bvh_stackless", "bih"}
    assert talk["kd"]["triangle_references"] == "834996"


def test_the_talks_figures_are_the_slides():
    by_name = {row.name: row for row in TALK.structures}
    assert by_name["bvh"].nodes == 113_994
    assert by_name["bih"].tree_mib == 2.15
    assert by_name["bvh_stackless"].traversals == 3.7035e11
    assert [row.registers for row in TALK.structures] == [14, 18, 15, 11]
    # Operations are time x 160 units x 750 MHz x utilisation: the slide is consistent.
    for row in TALK.structures:
        used = row.alu_operations / (row.time_s * 160 * 750e6)
        assert 100 * used == pytest.approx(row.alu_percent, abs=0.02)


def test_the_talk_is_attached_only_where_it_belongs(measured):
    assert talk_beside(SCENE, ("per_material",)) is TALK
    assert talk_beside(SCENE, ("one", "per_material")) is TALK
    assert talk_beside(SCENE, ("one",)) is None
    assert talk_beside("torus_park", ("per_material",)) is None
    assert measured.talk_2009 is None
    assert measured.to_dict()["talk_2009"] is None


def test_nothing_says_how_many_rays_the_talk_took(beside_the_talk):
    for format in ("json", "csv", "md"):
        text = table(beside_the_talk, format)
        assert "10,000" not in text and "10000 " not in text


@pytest.mark.parametrize("format", ["svg", "png"])
def test_a_chart_is_the_same_every_time(format, measured):
    drawn = chart(measured, format)
    assert drawn == chart(measured, format)
    if format == "png":
        assert np.asarray(Image.open(io.BytesIO(drawn)).convert("L")).std() > 10
    else:
        text = drawn.decode()
        assert "<svg" in text and "dc:date" not in text


def test_a_chart_without_scaling_has_fewer_panels(measured):
    whole = Image.open(io.BytesIO(chart(measured, "png")))
    less = Image.open(io.BytesIO(chart(dataclasses.replace(measured, scaling=None), "png")))
    assert less.height < whole.height and less.width == whole.width


def test_there_is_a_heat_map_for_each_structure_that_shows_its_steps(measured):
    assert set(measured.heat_maps) == {"bvh", "kd", "bvh, per material", "kd, per material"}


def test_a_heat_map_counts_what_a_pixels_ray_does(measured):
    scene = raysvc.load("builtin:cornell")
    built = contender(scene, Candidate("bvh", "bvh", {}), "one", slice(None))
    camera = camera_from(View(**VIEW), scene)
    costs = heat_map(built, camera, Control(2))
    assert costs.node_steps.shape == costs.triangle_tests.shape == (30, 40)
    origins, directions = camera.rays(np.array([12 * 40 + 7]))
    one = raysvc.accel.base.Rays(origins, directions, np.full(1, np.inf, np.float32))
    counters = built.structure.counted(one, "nearest")
    assert costs.node_steps[12, 7] == counters.node_steps[0]
    assert costs.triangle_tests[12, 7] == counters.triangle_tests[0]
    np.testing.assert_array_equal(measured.heat_maps["bvh"].node_steps, costs.node_steps)


def test_heat_maps_become_files(measured, tmp_path):
    drawn = heat_maps_png(measured.heat_maps)
    assert drawn == heat_maps_png(measured.heat_maps)
    picture = Image.open(io.BytesIO(drawn))
    assert picture.height > picture.width
    path = tmp_path / "costs.exr"
    path.write_bytes(heat_maps_exr(measured.heat_maps))
    channels = OpenEXR.File(str(path), separate_channels=True).channels()
    assert len(channels) == 2 * len(measured.heat_maps)
    np.testing.assert_array_equal(
        channels["kd_per_material.node_steps.V"].pixels,
        measured.heat_maps["kd, per material"].node_steps,
    )


def test_an_empty_picture_has_a_heat_map_too():
    nothing = HeatMap(np.zeros((4, 8), np.float32), np.zeros((4, 8), np.float32))
    assert heat_maps_png({"bvh": nothing}).startswith(b"\x89PNG")
