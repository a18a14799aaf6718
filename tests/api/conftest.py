"""One application per test: a small queue, its own folder, a renderer that paints a pattern."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from api.app import create_app
from api.settings import ApiSettings
from raysvc.jobs import PatternRenderer

MakeClient = Callable[..., TestClient]


@pytest.fixture
def make_client(tmp_path: Path) -> Iterator[MakeClient]:
    """Build an application from some settings, and talk to it until the next one or the test's end:
    a folder serves one application at a time."""
    with ExitStack() as stack:

        def make(renderer: PatternRenderer | None = None, **settings: Any) -> TestClient:
            stack.close()
            settings = {"data_dir": tmp_path, "grace_s": 0.2, "queue_size": 2, **settings}
            # Processes that read uploads take a second to start; tests of them ask for some.
            settings = {"parse_processes": 0, **settings}
            app = create_app(
                ApiSettings(**settings),
                lambda scenes, environments, limits: renderer or PatternRenderer(),
            )
            return stack.enter_context(TestClient(app, raise_server_exceptions=False))

        yield make


@pytest.fixture
def client(make_client: MakeClient) -> TestClient:
    return make_client()
