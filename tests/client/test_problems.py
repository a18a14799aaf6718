import pytest

from api.problems import PROBLEMS, error_body
from raysvc import errors
from raysvc.client.problems import error_from, error_kinds, problem_name


def every_error() -> list[errors.RaysvcError]:
    """One of every kind that the core raises, with all there is to say."""
    made: list[errors.RaysvcError] = []
    for kind in error_kinds().values():
        if kind is errors.QueueFull or kind is errors.Busy:
            made.append(kind("message", 3.0))  # type: ignore[arg-type]
        elif kind is errors.NotFinished:
            made.append(errors.NotFinished("message", "render", retryable=True))
        elif kind in PROBLEMS and kind is not errors.RaysvcError:
            made.append(kind("message", "settings.bounces"))
    return made


@pytest.mark.parametrize("error", every_error(), ids=lambda error: type(error).__name__)
def test_an_error_comes_out_as_it_went_in(error: errors.RaysvcError) -> None:
    found = error_from(error_body(error), {"retry-after": "3"})
    assert type(found) is type(error)
    assert vars(found) == vars(error)
    assert str(found) == str(error)


def test_problems_are_called_after_their_exceptions() -> None:
    for kind, problem in PROBLEMS.items():
        if kind.__module__ == errors.__name__ and kind is not errors.RaysvcError:
            assert problem.type == problem_name(kind)


@pytest.mark.parametrize(
    ("status", "kind"), [(400, errors.InvalidInput), (418, errors.InvalidInput), (500, None)]
)
def test_an_unknown_problem_blames_whom_its_status_blames(
    status: int, kind: type[errors.RaysvcError] | None
) -> None:
    found = error_from({"type": "urn:raysvc:problem:new", "title": "New", "status": status})
    assert type(found) is (kind or errors.RaysvcError)
    assert found.message == "New"


def test_what_the_key_would_have_to_be_for_comes_along() -> None:
    headers = {
        "www-authenticate": 'Bearer realm="raysvc", error="insufficient_scope", scope="admin"'
    }
    found = error_from(error_body(errors.NotAllowed("no")), headers)
    assert isinstance(found, errors.NotAllowed)
    assert found.scope == "admin"
