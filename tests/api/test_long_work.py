"""Filtering and refocusing may take as long as a job, and keep nobody else from a thread."""

import threading
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest

from api.routes import filtered
from tests.api.conftest import MakeClient

RENDER = {"scene": "builtin:cornell", "camera": {"width": 8, "height": 4}}
PATH = "/v1/environments/builtin:studio/filtered"
BODY = {"irradiance": True, "width": 16, "format": "exr"}


def test_long_work_leaves_threads_for_requests_and_one_too_many_is_sent_away(
    make_client: MakeClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    client = make_client(long_threads=2, heavy_threads=1)
    make, arrived, leave = filtered.filtered_maps, threading.Semaphore(0), threading.Event()

    def slow(*parts: Any, **options: Any) -> Any:
        arrived.release()
        leave.wait(30)
        return make(*parts, **options)

    monkeypatch.setattr(filtered, "filtered_maps", slow)
    with ThreadPoolExecutor(2) as clients:
        waiting = [clients.submit(client.post, PATH, json=BODY) for _ in range(2)]
        try:
            assert all(arrived.acquire(timeout=20) for _ in waiting)
            refused = client.post(PATH, json=BODY)
            assert refused.status_code == 429
            assert int(refused.headers["Retry-After"]) > 0
            assert client.post("/v1/renders", json=RENDER).status_code == 202
        finally:
            leave.set()
        assert [each.result(30).status_code for each in waiting] == [200, 200]
    assert client.post(PATH, json=BODY).status_code == 200
