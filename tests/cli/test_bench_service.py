import json
from pathlib import Path

import pytest

from raysvc.cli.app import run


@pytest.mark.slow
def test_the_service_is_measured(tmp_path: Path) -> None:
    output = tmp_path / "service.json"
    small = ["--rounds", "2", "--clients", "8", "--seconds", "1", "--renders", "4"]
    assert run(["bench", "service", "--json", str(output), *small]) == 0
    measured = json.loads(output.read_text())
    assert {"machine", "version", "results"} == set(measured)
    start, overhead, memory, load = measured["results"]
    assert [r["measured"] for r in measured["results"]] == ["start", "overhead", "memory", "load"]
    assert 0 < start["import_s"] < start["live_s"] < start["ready_s"]
    assert 0 < overhead["overhead_ms"] <= overhead["overhead_max_ms"]
    assert memory["end_mib"] is None or 50 < memory["end_mib"] < 4096
    assert load["clients"] == 8 and load["errors"] == 0 and load["ok"] >= 1
    assert 0 < load["healthz_p50_ms"] <= load["healthz_p99_ms"]
