"""The service is killed at random moments; `python -m bench.crash` does it for longer."""

import os
from pathlib import Path

import pytest

from bench.crash import crash_rounds


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="processes end otherwise there")
def test_no_accepted_render_is_lost_changed_or_made_again(tmp_path: Path) -> None:
    told = crash_rounds(tmp_path, rounds=8, renderer="pattern", seed=7)
    assert told["broken"] == []
    assert told["accepted"] >= 8
    assert told["seen_done_before_a_kill"] >= 1
    assert told["begun_more_than_once"] >= 1, "no kill came while a render ran"
