import dataclasses
import json

import numpy as np
import pytest

import raysvc
from raysvc.accel.registry import STRUCTURES
from raysvc.compare import measure
from raysvc.compare.compare import compare
from raysvc.compare.contenders import CHUNK, Contender, checksum, contender, rows
from raysvc.compare.measure import alone, paces
from raysvc.compare.ray_sets import RAY_KINDS, ray_set
from raysvc.compare.settings import Candidate, candidates, comparison_settings
from raysvc.errors import Cancelled, DeadlineExceeded, InvalidSetting, LimitExceeded
from raysvc.frame.view import View, camera_from
from raysvc.parallel import Control
from tests.scenes import camera

BUILD = """nodes, leaves, empty_leaves, max_depth, mean_depth, triangle_references,
mean_triangles_per_leaf, mean_triangles_per_nonempty_leaf, duplication, node_bytes, index_bytes,
tree_mib, sah_cost, epo, lcv, build_ms"""
TRAVERSAL = """node_steps_per_ray, box_tests_per_ray, plane_tests_per_ray, triangle_tests_per_ray,
stack_writes_per_step, max_stack_depth, bytes_per_ray, lane_utilisation, state_bytes,
mrays_per_s_one_thread, mrays_per_s_all_threads, iqr_one_thread, hits, hit_checksum"""
QUICK = {"count": 400, "rounds": 2, "builds": 1, "camera": {"gltf_camera": 0}}


def names(text):
    return set(text.replace(",", " ").split())


@pytest.fixture(scope="module")
def cornell():
    return raysvc.load("builtin:cornell")


@pytest.fixture(scope="module")
def everything(cornell):
    return compare(cornell, {**QUICK, "structures": tuple(STRUCTURES), "trees": "both"})


def test_the_names_are_those_that_callers_were_promised(everything):
    plain = everything.to_dict()
    assert set(plain["rays"]) == {"kind", "count", "seed"}
    for structure in plain["structures"]:
        assert set(structure) == {"name", "trees", "build", "traversal"}
        assert set(structure["build"]) == names(BUILD)
        assert set(structure["traversal"]) == names(TRAVERSAL)
    json.dumps(plain, allow_nan=False)


def test_every_structure_takes_part_with_both_kinds_of_trees(everything):
    found = [(structure.name, structure.trees) for structure in everything.structures]
    assert found == [(name, trees) for trees in ("one", "per_material") for name in STRUCTURES]
    assert set(everything.to_dict()["steps"]) == set(STRUCTURES)


@pytest.mark.parametrize("kind", RAY_KINDS)
def test_all_structures_find_the_same_hits(kind, cornell):
    settings = {**QUICK, "rays": kind, "structures": tuple(STRUCTURES), "trees": "both"}
    found = compare(cornell, settings).structures
    answers = {(s.traversal.hits, s.traversal.hit_checksum) for s in found}
    assert len(answers) == 1
    assert 0 < found[0].traversal.hits < 400


def test_what_embree_does_not_show_is_not_guessed(everything):
    embree = next(s for s in everything.structures if s.name == "embree")
    seen = {name for name in names(TRAVERSAL) if getattr(embree.traversal, name) is not None}
    times = "mrays_per_s_one_thread, mrays_per_s_all_threads, iqr_one_thread"
    assert seen == names(times) | {"hits", "hit_checksum"}
    assert {n for n in names(BUILD) if getattr(embree.build, n) is not None} == {"build_ms"}


def test_counters_are_means_over_exactly_these_rays(cornell):
    settings = {**QUICK, "rays": "diffuse", "structures": ("bvh",), "seed": 5}
    figures = compare(cornell, settings).structures[0].traversal
    view = camera_from(View(gltf_camera=0), cornell)
    rays = ray_set("diffuse", cornell, view, 400, 5).rays
    counters = contender(
        cornell, Candidate("bvh", "bvh", {}), "one", slice(None)
    ).structure.counted(rays, "nearest")
    assert figures.node_steps_per_ray == pytest.approx(counters.node_steps.mean())
    assert figures.triangle_tests_per_ray == pytest.approx(counters.triangle_tests.mean())
    writes = counters.stack_writes.sum() / counters.node_steps.sum()
    assert figures.stack_writes_per_step == pytest.approx(writes)
    assert figures.max_stack_depth == counters.max_stack_depth.max()
    assert figures.hits == (counters.triangle >= 0).sum()


def test_scaling_is_measured_with_parts_of_the_triangles_and_fewer_threads(cornell):
    settings = {**QUICK, "structures": ("bvh", "brute"), "scaling": True, "threads": 3}
    scaling = compare(cornell, settings).scaling
    counts = [point.triangles for point in scaling.triangles if point.name == "bvh"]
    whole = len(cornell.triangles)
    assert counts == [-(-whole // part) for part in (8, 4, 2, 1)]
    assert [point.threads for point in scaling.threads if point.name == "brute"] == [1, 2, 3]


def test_a_checksum_tells_answers_apart():
    hits = np.array([1.0, np.nan, 0.5, 2.0])
    assert checksum(hits) == checksum(hits * (1 + 1e-9))
    for other in ([np.nan, 1.0, 0.5, 2.0], [1.0, np.nan, 0.5, np.nan], [1.0, np.nan, 0.5, 2.01]):
        assert checksum(np.array(other)) != checksum(hits)


@dataclasses.dataclass
class Recorder:
    """Stands in for a structure; writes down when it is asked."""

    name: str
    asked: list
    stop: object = None

    def nearest_triangle(self, rays):
        self.asked.append(self.name)
        if self.stop is not None:
            self.stop()
        return np.full(len(rays), -1, np.int32)


def recorders(count, **more):
    asked: list[str] = []
    return asked, [
        Contender(Candidate(str(n), str(n), {}), "one", None, Recorder(str(n), asked, **more))
        for n in range(count)
    ]


def some_rays(count):
    return ray_set("primary", raysvc.load("builtin:cornell"), camera(), count, 0).rays


def test_structures_take_turns(monkeypatch):
    monkeypatch.setattr(measure, "SHORTEST_S", 0.0)
    asked, three = recorders(3)
    begun = []
    paces(three, some_rays(10), "nearest", (1,), 4, Control(1), begun.append)
    assert asked == ["0", "1", "2"] * 5
    assert len(begun) == 15


def test_few_rays_are_asked_until_the_clock_is_fine_enough(monkeypatch):
    monkeypatch.setattr(measure, "SHORTEST_S", 1.0)
    asked, one = recorders(1)
    monkeypatch.setattr(measure.time, "perf_counter", iter(np.arange(0, 9, 0.25)).__next__)
    pace = paces(one, some_rays(10), "nearest", (1,), 1, Control(1), lambda _: None)[0, 1]
    # The first pass takes a quarter of a second, so that four make one; they too take a quarter.
    assert len(asked) == 5
    assert pace.median == pytest.approx(4 * 10 / 0.25 / 1e6)


def test_cancelling_is_heeded_within_a_chunk():
    control = Control(1)
    asked, one = recorders(1, stop=control.cancel)
    with pytest.raises(Cancelled):
        one[0].ask(some_rays(5 * CHUNK), "nearest", control)
    assert len(asked) == 1


STAGES = ("making", "building", "judging", "counting", "timing", "mapping")


@pytest.mark.parametrize("stage", STAGES)
def test_a_comparison_can_be_cancelled_at_every_stage(stage, cornell):
    def on_progress(name, fraction):
        assert 0 <= fraction <= 1
        if name.startswith(stage):
            control.cancel()

    control = Control(1, on_progress=on_progress)
    settings = {**QUICK, "structures": ("brute",), "heat_map": True}
    settings["camera"] = {"gltf_camera": 0, "width": 40, "height": 30}
    with pytest.raises(Cancelled):
        compare(cornell, settings, control=control)
    # The next one need not wait for it.
    with alone(Control(1, deadline_s=1.0)):
        pass


def test_progress_grows_to_the_end(cornell):
    heard = []
    control = Control(2, on_progress=lambda stage, fraction: heard.append(fraction))
    compare(
        cornell,
        {**QUICK, "structures": ("brute", "bvh"), "scaling": True, "heat_map": True}
        | {"camera": {"gltf_camera": 0, "width": 40, "height": 30}},
        control=control,
    )
    assert heard == sorted(heard)
    assert heard[0] == 0.0 and 0.9 < heard[-1] < 1.0


def test_two_measurements_never_run_at_once(cornell):
    with alone(Control(1)), pytest.raises(DeadlineExceeded):
        compare(cornell, QUICK, control=Control(1, deadline_s=0.1))


@pytest.mark.parametrize(
    ("settings", "field"),
    [
        ({"rays": "purple"}, "rays"),
        ({"count": 0}, "count"),
        ({"structures": ("quadtree",)}, "structures"),
        ({"structures": ("bvh", "bvh")}, "structures"),
        ({"structures": ("bvh:max_leaf",)}, "structures"),
        ({"structures": ("bvh:max_leaf=0",)}, "structures.bvh.max_leaf"),
        ({"structures": ("bvh:colour=red",)}, "structures.bvh.colour"),
        ({"camera": {"width": 0}}, "camera.width"),
        ({"trees": "two"}, "trees"),
        ({"speed": 3}, "speed"),
    ],
)
def test_what_is_wrong_is_named(settings, field):
    with pytest.raises(InvalidSetting) as raised:
        candidates(comparison_settings(settings))
    assert raised.value.field == field


def test_parameters_are_read_from_the_name():
    settings = comparison_settings({"structures": ("bvh:max_leaf=2:bins=8", "bvh")})
    first, second = candidates(settings)
    assert (first.name, first.parameters) == ("bvh", {"max_leaf": 2, "bins": 8})
    assert (second.label, second.parameters) == ("bvh", {})


def test_brute_takes_part_only_when_it_is_named():
    assert {c.name for c in candidates(comparison_settings({}))} == set(STRUCTURES) - {"brute"}


@pytest.mark.parametrize(
    ("settings", "field"),
    [
        ({"count": 10_000_001}, "count"),
        ({"count": 1_000_000, "structures": ("brute",)}, "structures"),
        ({"count": 1, "structures": ("brute",), "heat_map": True}, "structures"),
        ({"heat_map": True, "camera": {"width": 4000, "height": 4000}}, "camera.width"),
    ],
)
def test_what_would_take_too_long_is_refused(settings, field, cornell):
    with pytest.raises(LimitExceeded) as raised:
        compare(cornell, settings)
    assert raised.value.field == field


def test_rows_are_views(cornell):
    rays = some_rays(10)
    assert np.shares_memory(rows(rays, 2, 5).origins, rays.origins)


def test_it_is_said_from_how_many_triangles_and_rays_quality_was_judged(everything):
    from raysvc.accel.quality import EPO_TRIANGLES, LCV_RAYS

    plain = everything.to_dict()
    expected = min(plain["triangles"], EPO_TRIANGLES)
    assert plain["sampled"] == {"epo_triangles": expected, "lcv_rays": LCV_RAYS}
