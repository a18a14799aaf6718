import json
import statistics

import pytest

from raysvc.compare import sat_benchmark
from raysvc.compare.sat_benchmark import bench_sat
from raysvc.errors import Cancelled, InvalidSetting, LimitExceeded
from raysvc.parallel import Control


@pytest.fixture(autouse=True)
def few_lookups(monkeypatch):
    monkeypatch.setattr(sat_benchmark, "LOOKUPS", 500)


@pytest.fixture
def measured():
    return bench_sat(24, 16, rounds=2, control=Control(2))


def results(measured, kind):
    return [result for result in measured["results"] if result["measured"] == kind]


def test_every_builder_is_measured_with_one_thread_and_with_all(measured):
    found = [
        (r["threads"], r["builder"], r["samples"], r["passes"]) for r in results(measured, "build")
    ]
    # ceil(log_k 24) + ceil(log_k 16)
    passes = [
        ("fused", None, 1),
        ("doubling", 2, 9),
        ("doubling", 16, 3),
        ("scan", None, 4),
        ("strips", None, 3),
    ]
    assert found == [(threads, *each) for threads in (1, 2) for each in passes]


def test_the_ratio_is_to_the_copy_with_as_many_threads(measured):
    builds = results(measured, "build")
    for result in builds:
        assert result["seconds"] > 0 and result["iqr"] >= 0
        assert result["ratio_to_copy"] == result["copy_seconds"] / result["seconds"]
    assert len({(r["threads"], r["copy_seconds"]) for r in builds}) == 2


def test_every_order_is_read_with_one_thread(measured):
    lookups = results(measured, "lookup")
    assert [(r["order"], r["threads"], r["lookups"]) for r in lookups] == [
        (order, 1, 500) for order in (1, 2, 3)
    ]
    assert all(r["mlookups_per_s"] > 0 and r["iqr"] >= 0 for r in lookups)


def test_the_file_says_on_what_it_was_measured(measured):
    assert {"machine", "version", "rounds", "results"} <= set(measured)
    assert all((r["width"], r["height"]) == (24, 16) for r in measured["results"])
    json.dumps(measured, allow_nan=False)


def test_builders_take_turns_with_the_copy_and_the_first_round_does_not_count(monkeypatch):
    clock, order = [0.0], []

    def slower_and_slower():
        clock[0] += 1.0
        return clock[0]

    built = sat_benchmark.build_table

    def noted(image, builder, **asked):
        order.append((builder, asked.get("samples")))
        clock[0] += 10.0
        return built(image, builder, **asked)

    monkeypatch.setattr(sat_benchmark.time, "perf_counter", slower_and_slower)
    monkeypatch.setattr(sat_benchmark, "build_table", noted)
    found = results(bench_sat(8, 8, rounds=3, control=Control(1)), "build")
    assert order == list(sat_benchmark.BUILDS) * 4
    # A turn is one tick of the clock, and a build ten more
    assert [r["seconds"] for r in found] == [11.0] * 5
    assert statistics.mean(r["ratio_to_copy"] for r in found) == pytest.approx(1 / 11)


def test_progress_goes_from_none_to_all(monkeypatch):
    heard = []
    control = Control(1, on_progress=lambda stage, part: heard.append((stage, part)))
    bench_sat(8, 8, rounds=1, control=control)
    # A copy and five builds, and three orders, twice
    assert [part for _, part in heard] == pytest.approx([k / 18 for k in range(18)])
    assert heard[0][0] == "1 threads, copy" and heard[-1][0] == "lookups, 3"


def test_a_benchmark_can_be_stopped():
    control = Control(1)
    control.cancel()
    with pytest.raises(Cancelled):
        bench_sat(8, 8, control=control)


def test_sizes_out_of_range_are_refused():
    with pytest.raises(InvalidSetting, match="size: must be at least 1x1, is 0x4"):
        bench_sat(0, 4)
    with pytest.raises(LimitExceeded, match="size: may have 33,554,432 texels, has 33,562,624"):
        bench_sat(8194, 4096)
