import math

from hypothesis import given
from hypothesis import strategies as st

from api.exposition import Counter, Histogram, Read, text_of
from tests.api.prometheus_text import samples_of, value

TEXTS = st.text(
    st.characters(exclude_categories=("Cs", "Zl", "Zp", "Cc")) | st.sampled_from('"\\\n')
)


@given(st.lists(st.tuples(TEXTS, st.floats(0, 1e12))))
def test_what_is_counted_can_be_read_back(counted: list[tuple[str, float]]) -> None:
    counter = Counter("things_total", "Things\nand \\ such.", ("what",))
    sums: dict[str, float] = {}
    for what, amount in counted:
        counter.add(what, amount=amount)
        sums[what] = sums.get(what, 0.0) + amount
    samples = samples_of(text_of([counter]))
    assert {dict(labels)["what"]: found for (_, labels), found in samples.items()} == sums


@given(st.lists(st.floats(0, 1e3)))
def test_a_bucket_counts_what_is_no_greater(values: list[float]) -> None:
    bounds = (0.1, 1.0, 10.0)
    histogram = Histogram("time_seconds", "Time.", bounds, ("stage",))
    for seen in values:
        histogram.observe(seen, "lens")
    samples = samples_of(text_of([histogram]))
    for bound in (*bounds, math.inf):
        shown = {0.1: "0.1", 1.0: "1", 10.0: "10"}.get(bound, "+Inf")
        expected = sum(seen <= bound for seen in values)
        assert value(samples, "time_seconds_bucket", stage="lens", le=shown) == expected
    assert value(samples, "time_seconds_count", stage="lens") == len(values)
    assert math.isclose(value(samples, "time_seconds_sum", stage="lens"), sum(values))


def test_what_others_know_is_asked_when_it_is_shown() -> None:
    waiting = 0
    family = Read("queue_jobs", "Jobs.", lambda: {(): waiting})
    waiting = 3
    assert value(samples_of(text_of([family])), "queue_jobs") == 3
