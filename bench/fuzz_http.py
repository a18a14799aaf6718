"""Thousands of requests, right and wrong, made from the OpenAPI document: none may be answered with
5xx, or with anything that the document does not say.

    python -m bench.fuzz_http [--examples N] [--seed N]

Starts a service of its own, in a temporary folder, with short deadlines. Needs schemathesis, which
the tests' dependencies (`dev`) bring along. The exit code is 0 if nothing was found.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx

from raysvc.cli.service_process import running_service

CHECKS = (
    "not_a_server_error",
    "status_code_conformance",
    "content_type_conformance",
    "response_headers_conformance",
    "response_schema_conformance",
)
"""What an answer is held to."""
SETTINGS = {
    "RAYSVC_DEADLINE_S": "1",
    "RAYSVC_WAIT_MAX_S": "1",
    "RAYSVC_QUEUE_SIZE": "8",
    "RAYSVC_GRACE_S": "1",
}
"""So that no request takes long."""
PHASES = ("examples", "coverage", "fuzzing")
"""What the document gives, the ends of all that it says, and whatever it allows or forbids."""
READY_S = 300.0
MOST_FAILURES = 5
"""Of the service's own that are shown."""


def main() -> int:
    """Do as the command line says."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n\n")[0])
    parser.add_argument("--examples", type=int, default=300, help="cases per route and phase")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--report", type=Path, help="keep what was asked and answered (NDJSON)")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="raysvc-fuzz-") as folder, service(Path(folder)) as url:
        began = time.monotonic()
        code = fuzz(url, options.examples, options.seed, options.report)
        print(f"{time.monotonic() - began:.0f} seconds")  # noqa: T201
        assert httpx.get(f"{url}/healthz", timeout=10).status_code == 200
    return code


def fuzz(
    url: str,
    examples: int,
    seed: int,
    report: Path | None = None,
    phases: Sequence[str] = PHASES,
) -> int:
    """Run schemathesis against a service; returns its exit code."""
    command = [
        *(sys.executable, "-m", "schemathesis.cli", "run", f"{url}/openapi.json"),
        *("--checks", ",".join(CHECKS), "--phases", ",".join(phases)),
        *("--max-examples", str(examples), "--seed", str(seed), "--workers", "1"),
        *("--request-timeout", "60", "--continue-on-failure", "--suppress-health-check", "all"),
        *("--warnings", "off"),
    ]
    if report is not None:
        command += ["--report", "ndjson", "--report-ndjson-path", str(report)]
    environment = {**os.environ, "SCHEMATHESIS_HOOKS": "bench.fuzz_hooks", **_things(url)}
    return subprocess.run(command, env=environment, check=False).returncode


def _things(url: str) -> dict[str, str]:
    """Put something of every kind into a service; returns what `bench.fuzz_hooks` wants to know."""
    camera = {"width": 32, "height": 18}
    bodies: dict[str, dict[str, Any]] = {
        "scenes": {"builtin": "cornell"},
        "environments": {"builtin": "gradient"},
        "renders": {"scene": "builtin:cornell", "camera": camera},
        "comparisons": {"scene": "builtin:cornell", "count": 100, "structures": ["bvh"]},
    }
    found = {}
    for kind, body in bodies.items():
        answer = httpx.post(f"{url}/v1/{kind}", json=body, headers={"Prefer": "wait=1"}, timeout=60)
        found[f"RAYSVC_FUZZ_{kind.upper()}"] = answer.raise_for_status().json()["id"]
    return found


@contextmanager
def service(folder: Path, **settings: str) -> Iterator[str]:
    """A service that is ready, by its address; what it says goes to a file."""
    with running_service(folder / "data", {**SETTINGS, **settings}) as running:
        try:
            running.wait_until(lambda: _is_ready(running.url), READY_S)
            yield running.url
        finally:
            running.process.terminate()
            running.process.wait(60)
            failures = re.findall(
                r"^Traceback .*?^\w[\w.]*: .*?$", running.log.read_text(), re.MULTILINE | re.DOTALL
            )
            print(*failures[:MOST_FAILURES], sep="\n")  # noqa: T201


def _is_ready(url: str) -> bool:
    try:
        return httpx.get(f"{url}/readyz").is_success
    except httpx.TransportError:
        return False


if __name__ == "__main__":
    sys.exit(main())
