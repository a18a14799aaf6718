from raysvc.jobs.lru import LeastRecentlyUsed


def test_what_was_used_longest_ago_makes_room() -> None:
    values: LeastRecentlyUsed[str] = LeastRecentlyUsed(6, len)
    values.put("a", "aa")
    values.put("b", "bb")
    values.put("c", "cc")
    assert values.get("a") == "aa"
    values.put("d", "d")
    assert values.get("b") is None
    assert values.get("a") == "aa"


def test_the_newest_is_kept_even_if_it_is_too_heavy() -> None:
    values: LeastRecentlyUsed[str] = LeastRecentlyUsed(3, len)
    values.put("small", "s")
    values.put("large", "much too large")
    assert values.get("large") == "much too large"
    assert values.get("small") is None


def test_putting_the_same_name_again_counts_once() -> None:
    values: LeastRecentlyUsed[str] = LeastRecentlyUsed(4, len)
    for _ in range(5):
        values.put("a", "aa")
    values.put("b", "bb")
    assert values.get("a") == "aa"


def test_what_is_dropped_is_gone_and_weighs_nothing() -> None:
    values: LeastRecentlyUsed[str] = LeastRecentlyUsed(4, len)
    values.put("a", "aaaa")
    values.drop("a")
    values.drop("never there")
    values.put("b", "bb")
    values.put("c", "cc")
    assert values.get("a") is None
    assert values.get("b") == "bb"
