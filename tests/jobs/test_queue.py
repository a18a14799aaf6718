import threading

import pytest

from raysvc.errors import Draining, QueueFull
from raysvc.jobs import JobQueue
from tests.jobs.requests import job


def test_jobs_leave_in_the_order_in_which_they_came() -> None:
    queue = JobQueue(3)
    jobs = [job(str(n)) for n in range(3)]
    for each in jobs:
        queue.put(each)
    assert [queue.position(each) for each in jobs] == [0, 1, 2]
    assert [queue.take() for _ in range(3)] == jobs


def test_a_full_queue_refuses_and_says_when_to_come_back() -> None:
    queue = JobQueue(2)
    queue.put(job())
    queue.put(job())
    queue.took(30.0)
    with pytest.raises(QueueFull) as raised:
        queue.put(job())
    assert raised.value.retryable
    assert 1.0 <= raised.value.retry_after_s <= 60.0


def test_a_cancelled_job_gives_its_place_free() -> None:
    queue = JobQueue(1)
    first, second = job("first"), job("second")
    queue.put(first)
    first.cancel()
    queue.put(second)
    assert queue.take() is second
    assert queue.position(first) is None


def test_taking_waits_for_a_job() -> None:
    queue, taken = JobQueue(1), []
    thread = threading.Thread(target=lambda: taken.append(queue.take()))
    thread.start()
    some = job()
    queue.put(some)
    thread.join(5)
    assert taken == [some]


def test_closing_ends_the_wait_and_leaves_the_line_as_it_is() -> None:
    queue = JobQueue(2)
    some = job()
    queue.put(some)
    queue.close()
    assert queue.take() is None
    assert queue.position(some) == 0
    with pytest.raises(Draining, match="shutting down"):
        queue.put(job())


def test_what_was_accepted_before_joins_a_line_that_is_full() -> None:
    queue = JobQueue(1)
    jobs = [job(str(n)) for n in range(3)]
    for each in jobs:
        queue.put_back(each)
    with pytest.raises(QueueFull):
        queue.check_room()
    assert [queue.take() for _ in range(3)] == jobs


def test_a_cancelled_job_is_not_counted() -> None:
    queue, some = JobQueue(2), job()
    queue.put(some)
    assert len(queue) == 1
    some.cancel()
    assert len(queue) == 0
