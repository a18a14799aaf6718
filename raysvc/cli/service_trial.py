"""Measures a service from outside: a process of its own, asked over HTTP as anyone would."""

import math
import multiprocessing
import statistics
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from functools import partial
from itertools import count
from pathlib import Path
from typing import Any, Final

import httpx

from raysvc.cli.service_process import running_service

SCENE: Final = "builtin:cornell"
CAMERA: Final = {"width": 320, "height": 180}
RESULT_MEMORY_BYTES: Final = 32 << 20
"""So small that it is full when memory begins to be watched."""
HEALTH_PACE_S: Final = 0.02
LONGEST_START_S: Final = 600.0
WARM_UP: Final = 0.4
"""The part of the renders after which memory is expected to stay as it is."""

Report = Callable[[str, float], None]


@contextmanager
def service_on_trial(data_dir: Path) -> Iterator[tuple[httpx.Client, int, dict[str, float]]]:
    """Start a service; yields a client, the process's number, and how long what took."""
    began = time.perf_counter()
    settings = {"RAYSVC_RESULT_MEMORY_BYTES": str(RESULT_MEMORY_BYTES)}
    with running_service(data_dir, settings, drain=False) as service:
        took = {"import_s": time.perf_counter() - began}
        with httpx.Client(base_url=service.url, timeout=120) as client:
            for name, path in (("live_s", "/healthz"), ("ready_s", "/readyz")):
                service.wait_until(partial(_succeeds, client, path), LONGEST_START_S)
                took[name] = time.perf_counter() - began
            yield client, service.process.pid, took


def overhead(client: httpx.Client, rounds: int, report: Report) -> dict[str, Any]:
    """What HTTP and the job add to a render, and what its picture takes, medians in ms."""
    added, pictures = [], []
    for number in range(rounds + 1):
        began = time.perf_counter()
        answer = client.post("/v1/renders", json=_body(number), headers={"Prefer": "wait=60"})
        waited = time.perf_counter() - began
        rendered = answer.raise_for_status().json()
        began = time.perf_counter()
        client.get(rendered["links"]["image"]).raise_for_status()
        if number:  # the first one prepares the scene
            pictures.append(time.perf_counter() - began)
            added.append(waited - rendered["statistics"]["total_seconds"])
        report("overhead", number / rounds)
    return {
        "measured": "overhead",
        "rounds": rounds,
        "overhead_ms": 1000 * statistics.median(added),
        "overhead_max_ms": 1000 * max(added),
        "picture_ms": 1000 * statistics.median(pictures),
    }


def load(client: httpx.Client, clients: int, seconds: float, report: Report) -> dict[str, Any]:
    """What so many clients are answered that ask for ever new renders without a pause."""
    took = []
    # The crowd is a process of its own: what waits here for the interpreter is not the service's.
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        began_s = time.monotonic()
        answers = pool.submit(crowd, str(client.base_url), clients, seconds)
        while not answers.done():
            began = time.perf_counter()
            client.get("/healthz").raise_for_status()
            took.append(time.perf_counter() - began)
            report("load", min((time.monotonic() - began_s) / seconds, 1.0))
            time.sleep(HEALTH_PACE_S)
        statuses = answers.result()
    took.sort()
    ok, rejected = sum(n for status, n in statuses.items() if 200 <= status < 300), statuses[429]
    return {
        "measured": "load",
        "clients": clients,
        "seconds": seconds,
        "ok": ok,
        "rejected": rejected,
        "errors": statuses.total() - ok - rejected,
        "healthz_p50_ms": 1000 * statistics.median(took),
        "healthz_p99_ms": 1000 * took[math.ceil(0.99 * len(took)) - 1],
    }


def crowd(address: str, clients: int, seconds: float) -> Counter[int]:
    """Ask with so many clients at once; returns how often each status was answered, 0 for none."""
    end, seeds, statuses = time.monotonic() + seconds, count(1_000_000), Counter[int]()
    lock = threading.Lock()

    def ask() -> None:
        with httpx.Client(base_url=address, timeout=120) as own:
            while time.monotonic() < end:
                try:
                    status = own.post("/v1/renders", json=_body(next(seeds))).status_code
                except httpx.TransportError:
                    status = 0
                with lock:
                    statuses[status] += 1

    threads = [threading.Thread(target=ask) for _ in range(clients)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return statuses


def memory(client: httpx.Client, process: int, renders: int, report: Report) -> dict[str, Any]:
    """How the process grows over so many renders, once it is warm; null where that is not seen."""
    warm, warm_bytes = round(WARM_UP * renders), None
    for number in range(renders):
        if number == warm:
            warm_bytes = resident_bytes(process)
        answer = client.post(
            "/v1/renders", json=_body(2_000_000 + number), headers={"Prefer": "wait=60"}
        )
        client.get(answer.raise_for_status().json()["links"]["image"]).raise_for_status()
        report("memory", number / renders)
    end_bytes = resident_bytes(process)
    known = warm_bytes is not None and end_bytes is not None
    return {
        "measured": "memory",
        "renders": renders,
        "warm_mib": _mib(warm_bytes),
        "end_mib": _mib(end_bytes),
        "growth": end_bytes / warm_bytes - 1 if known and warm_bytes and end_bytes else None,
    }


def resident_bytes(process: int) -> int | None:
    """Memory of a process without mapped files, or None where the system does not say."""
    try:
        lines = Path(f"/proc/{process}/status").read_text(encoding="ascii").splitlines()
    except OSError:
        return None
    return next((1024 * int(line.split()[1]) for line in lines if line.startswith("RssAnon")), None)


def _body(seed: int) -> Mapping[str, Any]:
    return {"scene": SCENE, "camera": CAMERA, "settings": {"seed": seed}}


def _mib(size: int | None) -> float | None:
    return None if size is None else size / (1 << 20)


def _succeeds(client: httpx.Client, path: str) -> bool:
    try:
        return client.get(path).is_success
    except httpx.TransportError:
        return False
