"""Chunks on threads: every item once, errors and stops heard, progress told."""

import threading
import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from raysvc.errors import Cancelled, DeadlineExceeded
from raysvc.parallel import Control, available_threads, for_chunks, for_waves, map_chunks


@settings(deadline=None, max_examples=60)
@given(st.integers(0, 200), st.integers(1, 70), st.sampled_from([1, 2, 5]))
def test_every_item_is_in_exactly_one_chunk(count, chunk, threads):
    times = np.zeros(count, int)
    sizes = []

    def work(begin, end):
        times[begin:end] += 1
        sizes.append(end - begin)

    for_chunks(count, chunk, work, Control(threads=threads))
    assert (times == 1).all()
    assert all(0 < size <= chunk for size in sizes)


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_results_come_in_the_order_of_their_items(threads):
    def work(begin, end):
        time.sleep(0.002 * (begin % 3))
        return (begin, end)

    found = map_chunks(10, 3, work, Control(threads=threads))
    assert found == [(0, 3), (3, 6), (6, 9), (9, 10)]


def test_chunks_do_not_depend_on_the_number_of_threads():
    chunks = [map_chunks(100, 7, lambda a, b: (a, b), Control(threads=n)) for n in (1, 2, 5)]
    assert chunks[0] == chunks[1] == chunks[2]


def test_no_items_are_no_work():
    assert map_chunks(0, 10, lambda a, b: 1 / 0, Control()) == []


def test_several_threads_are_used_at_once():
    together = threading.Barrier(3, timeout=5)
    for_chunks(3, 1, lambda a, b: together.wait(), Control(threads=3))


@pytest.mark.parametrize("threads", [1, 3])
def test_an_error_stops_the_rest_and_is_raised(threads):
    done = []

    def work(begin, end):
        if begin == 2:
            raise ValueError("the third")
        time.sleep(0.002)
        done.append(begin)

    with pytest.raises(ValueError, match="the third"):
        for_chunks(1000, 1, work, Control(threads=threads))
    assert len(done) < 100


@pytest.mark.parametrize("threads", [1, 3])
def test_cancelling_stops_at_the_next_chunk(threads):
    control = Control(threads=threads)
    done = []

    def work(begin, end):
        done.append(begin)
        if begin == 3:
            control.cancel()

    with pytest.raises(Cancelled):
        for_chunks(1000, 1, work, control)
    assert len(done) < 50


@pytest.mark.parametrize("threads", [1, 3])
def test_a_deadline_stops_at_the_next_chunk(threads):
    start = time.monotonic()
    with pytest.raises(DeadlineExceeded) as caught:
        for_chunks(
            1000, 1, lambda a, b: time.sleep(0.01), Control(threads=threads, deadline_s=0.05)
        )
    assert time.monotonic() - start < 2
    assert caught.value.field == "deadline_s"


def test_progress_ends_at_one_and_never_goes_back():
    told = []
    for_chunks(
        20,
        2,
        lambda a, b: time.sleep(0.001),
        Control(threads=4, on_progress=lambda stage, part: told.append((stage, part))),
        "light",
    )
    assert {stage for stage, _ in told} == {"light"}
    parts = [part for _, part in told]
    assert sorted(parts) == pytest.approx(np.arange(1, 11) / 10)
    assert parts == sorted(parts)


def test_a_stage_without_a_name_tells_nothing():
    told = []
    for_chunks(9, 2, lambda a, b: None, Control(1, on_progress=lambda *what: told.append(what)))
    assert told == []


def test_an_error_in_the_listener_is_raised():
    def listener(stage, part):
        raise RuntimeError("nobody listens")

    with pytest.raises(RuntimeError, match="nobody listens"):
        for_chunks(9, 2, lambda a, b: None, Control(2, on_progress=listener), "light")


def test_threads_are_all_processors_unless_said():
    assert Control().threads == available_threads() >= 1
    assert Control(threads=3).threads == 3


def test_limited_takes_the_threads_and_the_nearer_deadline():
    control = Control(threads=4, deadline_s=0.0)
    time.sleep(0.002)
    late = control.limited(2, 1000.0)
    assert late.threads == 2
    with pytest.raises(DeadlineExceeded):
        late.check()
    early = Control().limited(None, 0.0)
    time.sleep(0.002)
    with pytest.raises(DeadlineExceeded):
        early.check()
    unlimited = Control(threads=4).limited(None, None)
    assert unlimited.threads == 4
    unlimited.check()


def test_cancelling_reaches_limited_controls_and_back():
    control = Control()
    limited = control.limited(1, None)
    limited.cancel()
    with pytest.raises(Cancelled):
        control.check()


def test_limits_do_not_change_the_control_they_come_from():
    control = Control(threads=4)
    control.limited(1, 0.0)
    assert control.threads == 4
    control.check()


def test_a_quiet_control_says_nothing_and_still_stops():
    heard = []
    control = Control(2, on_progress=lambda *told: heard.append(told))
    for_chunks(4, 1, lambda a, b: None, control.quiet(), "quiet")
    assert heard == []
    control.cancel()
    with pytest.raises(Cancelled):
        control.quiet().check()


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_a_wave_comes_after_the_one_before_it_and_after_its_own_last_step(threads):
    ended = np.zeros((4, 7), bool)

    def work(lane, step):
        assert not ended[lane, step]
        assert lane == 0 or ended[lane - 1, step]
        assert step == 0 or ended[lane, step - 1]
        time.sleep(0.001 * ((3 * lane + step) % 3))
        ended[lane, step] = True

    for_waves(4, 7, work, Control(threads=threads))
    assert ended.all()


def test_waves_of_two_lanes_run_at_once():
    together = threading.Barrier(2, timeout=5)

    def work(lane, step):
        if (lane, step) in ((0, 1), (1, 0)):
            together.wait()

    for_waves(2, 3, work, Control(threads=2))


@pytest.mark.parametrize("threads", [1, 3])
@pytest.mark.parametrize("bad", [0, 1, 2])
def test_an_error_in_a_wave_stops_the_lanes_that_wait_for_it(threads, bad):
    done = []

    def work(lane, step):
        if (lane, step) == (bad, 1):
            raise ValueError("broken")
        done.append((lane, step))

    with pytest.raises(ValueError, match="broken"):
        for_waves(3, 50, work, Control(threads=threads))
    assert all(step <= 1 for lane, step in done if lane >= bad)
