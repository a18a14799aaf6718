import pytest

from api.negotiation import format_for, matches, wait_seconds
from api.problems import NotAcceptable

BROWSER = "image/avif,image/webp,image/apng,image/svg+xml,image/*,*/*;q=0.8"


@pytest.mark.parametrize(
    ("accept", "format"),
    [
        (None, "png"),
        (" ", "png"),
        ("*/*", "png"),
        ("image/*", "png"),
        (BROWSER, "png"),
        ("image/webp,*/*;q=0.1", "webp"),
        ("image/png;q=0, image/*", "jpg"),
        ("image/x-exr", "exr"),
        ("image/exr", "exr"),
        ("application/x-npz, image/png;q=0.9", "npz"),
        ("IMAGE/JPEG ; Q=0.3", "jpg"),
        ("text/html;q=zzz, image/webp", "webp"),
    ],
)
def test_the_best_accepted_format_wins(accept: str | None, format: str) -> None:
    assert format_for(accept) == format


@pytest.mark.parametrize("accept", ["text/html", "image/png;q=0", "image/gif, image/png;q=bad"])
def test_without_an_accepted_format_there_is_an_error(accept: str) -> None:
    with pytest.raises(NotAcceptable):
        format_for(accept)


@pytest.mark.parametrize(
    ("prefer", "seconds"),
    [
        ([], None),
        (["wait=10"], 10.0),
        (["respond-async, wait=5"], 5.0),
        (["respond-async", "Wait=7"], 7.0),
        (['wait="3"'], 3.0),
        (["wait=soon"], None),
        (["wait=-1"], None),
        (["await=9"], None),
    ],
)
def test_the_wished_wait_is_understood_or_ignored(prefer: list[str], seconds: float | None) -> None:
    assert wait_seconds(prefer) == seconds


def test_entity_tags_are_compared_weakly() -> None:
    assert matches('"a", W/"b"', '"b"')
    assert matches("*", '"b"')
    assert not matches('"a"', '"b"')
    assert not matches(None, '"b"')
