"""Requests made from the OpenAPI document are answered as it says; `bench.fuzz_http` makes more."""

from pathlib import Path

import pytest

from bench.fuzz_http import fuzz, service

EXAMPLES = 3
"""Per route, beside those that the document's bounds suggest."""


@pytest.mark.slow
def test_no_request_is_answered_otherwise_than_documented(tmp_path: Path) -> None:
    pytest.importorskip("schemathesis", exc_type=ImportError)
    with service(tmp_path) as url:
        assert fuzz(url, EXAMPLES, seed=20091123, phases=("examples", "fuzzing")) == 0
