from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest

from api.app import create_app
from api.settings import ApiSettings
from raysvc.client import Client
from raysvc.jobs import PatternRenderer
from tests.live import listening

MakeClient = Callable[..., Client]
Serve = Callable[..., str]


@pytest.fixture
def serve(tmp_path: Path) -> Iterator[Serve]:
    """Serve an application that paints patterns over a socket; returns its address."""
    with ExitStack() as stack:

        def serve_one(renderer: PatternRenderer | None = None, **settings: Any) -> str:
            settings = {"data_dir": tmp_path / "data", "grace_s": 0.2, "queue_size": 2, **settings}
            app = create_app(
                ApiSettings(**settings),
                lambda scenes, environments, limits: renderer or PatternRenderer(),
            )
            return stack.enter_context(listening(app))

        yield serve_one


@pytest.fixture
def make_client(serve: Serve) -> Iterator[MakeClient]:
    """Serve an application, and talk to it."""
    with ExitStack() as stack:

        def make(renderer: PatternRenderer | None = None, **settings: Any) -> Client:
            return stack.enter_context(Client(serve(renderer, **settings), patience_s=5.0))

        yield make


@pytest.fixture
def client(make_client: MakeClient) -> Client:
    return make_client()
