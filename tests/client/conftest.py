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


@pytest.fixture
def make_client(tmp_path: Path) -> Iterator[MakeClient]:
    """Serve an application that paints patterns, and talk to it over a socket."""
    with ExitStack() as stack:

        def make(
            renderer: PatternRenderer | None = None, key: str | None = None, **settings: Any
        ) -> Client:
            settings = {"data_dir": tmp_path / "data", "grace_s": 0.2, "queue_size": 2, **settings}
            app = create_app(
                ApiSettings(**settings),
                lambda scenes, environments, limits: renderer or PatternRenderer(),
            )
            url = stack.enter_context(listening(app))
            return stack.enter_context(Client(url, key, patience_s=5.0))

        yield make


@pytest.fixture
def client(make_client: MakeClient) -> Client:
    return make_client()
