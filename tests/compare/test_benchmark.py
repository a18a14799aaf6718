import json
import socket

import pytest

import raysvc
from raysvc.accel.registry import STRUCTURES
from raysvc.compare.benchmark import bench_structures
from raysvc.compare.machine import machine
from raysvc.compare.ray_sets import RAY_KINDS
from raysvc.errors import Cancelled
from raysvc.parallel import Control

PROMISED = "scene rays query structure robust threads mrays_per_s ratio_to_embree".split()


@pytest.fixture(scope="module")
def measured():
    scenes = {"builtin:cornell": raysvc.load("builtin:cornell")}
    return bench_structures(scenes, 200, 1, control=Control(2))


def test_every_structure_meets_embree_on_every_set_of_rays(measured):
    found = {
        (r["rays"], r["query"], r["structure"], r["robust"], r["threads"])
        for r in measured["results"]
    }
    entrants = {(name, True) for name in STRUCTURES if name != "brute"} | {("embree", False)}
    assert found == {
        (rays, query, *entrant, threads)
        for rays in RAY_KINDS
        for query in ("nearest", "occluded")
        for entrant in entrants
        for threads in (1, 2)
    }
    assert len(measured["results"]) == len(found)


def test_results_have_the_names_that_readers_were_promised(measured):
    assert {"machine", "version", "results"} <= set(measured)
    for result in measured["results"]:
        assert set(PROMISED) <= set(result)
        assert result["mrays_per_s"] > 0 and result["iqr"] >= 0
    json.dumps(measured, allow_nan=False)


def test_embree_is_compared_with_itself_and_the_others_with_it(measured):
    embree = {
        (r["rays"], r["query"], r["threads"], r["robust"]): r["mrays_per_s"]
        for r in measured["results"]
        if r["structure"] == "embree"
    }
    for r in measured["results"]:
        theirs = embree[r["rays"], r["query"], r["threads"], r["robust"]]
        assert r["ratio_to_embree"] == pytest.approx(r["mrays_per_s"] / theirs)


def test_a_benchmark_can_be_stopped():
    control = Control(1)
    control.cancel()
    with pytest.raises(Cancelled):
        bench_structures({"cornell": raysvc.load("builtin:cornell")}, 10, 1, control=control)


def test_the_machine_is_described_without_naming_it():
    described = machine()
    assert described["threads"] >= 1 and described["packages"]["numpy"]
    assert socket.gethostname() not in described.values()
