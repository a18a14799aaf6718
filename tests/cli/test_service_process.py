"""A service that a command starts: where it is, and what is said if it does not come up."""

from pathlib import Path

import httpx
import pytest

from raysvc.cli.service_process import running_service
from raysvc.errors import RaysvcError


def test_a_service_that_does_not_start_says_why(tmp_path: Path) -> None:
    wrong = {"RAYSVC_QUEUE_SIZE": "many"}
    with (
        pytest.raises(RaysvcError, match=r"did not start: (.|\n)*RAYSVC_QUEUE_SIZE"),
        running_service(tmp_path, wrong) as service,
    ):
        service.wait_until(lambda: False, 60)


@pytest.mark.slow
def test_a_service_is_where_it_says_and_ends(tmp_path: Path) -> None:
    def answers() -> bool:
        try:
            return httpx.get(f"{service.url}/healthz").is_success
        except httpx.TransportError:
            return False

    with running_service(tmp_path, drain=False) as service:
        service.wait_until(answers, 60)
        with pytest.raises(RaysvcError, match="not ready within 0 s"):
            service.wait_until(lambda: False, 0.1)
    assert service.process.returncode
    assert not answers()
