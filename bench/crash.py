"""Kill the service at random moments, and see whether it keeps its word.

    python -m bench.crash --rounds 50 [--renderer scene] [--seed 0]

A round starts the service on the same folder, sends it renders, and kills it (SIGKILL) at a random
moment: while it starts, or any time later; in one round of four after it has finished something.
In the end it is left alone, and then

- every render that was accepted is done, with the same bytes as from a service that nobody killed,
  but for the few that a kill hit three times: those say so, and are at most one in ten
- none that was seen to be done was begun again, although everything is asked for once more
- no half-written file is left
"""

import argparse
import json
import random
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx

from bench.crash_service import BEGUN

RENDERS = 4
"""Asked for in a round."""
LONGEST_LIFE_S = {"pattern": 0.8, "scene": 4.0}
"""From when the service says where it is, or with scenes is ready, to its death, at most."""
STILLBORN = 4
"""One in so many rounds, the service is also killed before it can say where it is."""
LONGEST_BIRTH_S = 3.0
PATIENCE_S = 300.0
LARGEST_CRASHED_SHARE = 0.1
"""Of the accepted renders, those that kills may hit three times; they come when a render runs."""


@dataclass
class Witness:
    """What clients were told."""

    accepted: dict[int, str] = field(default_factory=dict)
    """Links of the renders by their seeds."""
    done: dict[int, int] = field(default_factory=dict)
    """How often those were begun that were seen to be done, when they were."""
    unheard: set[int] = field(default_factory=set)
    """Sent, and no answer came."""


@contextmanager
def service(folder: Path, renderer: str) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """Start a service; yields its process and address, and kills it in the end."""
    command = [sys.executable, "-m", "bench.crash_service", str(folder), renderer]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            yield process, process.stdout.readline().strip()
        finally:
            process.kill()


def body(seed: int) -> dict[str, Any]:
    """A render that is unlike all others."""
    camera = {"width": 16 + seed, "height": 12}
    settings = {"seed": seed, "occlusion_samples": 1, "aa": "none"}
    return {"scene": "builtin:cornell", "camera": camera, "settings": settings}


def begun(folder: Path) -> Counter[int]:
    """How often each render was begun."""
    with suppress(FileNotFoundError):
        return Counter(int(line) for line in (folder / BEGUN).read_text().split())
    return Counter()


def post(client: httpx.Client, seed: int, key: str) -> httpx.Response:
    """Ask for a render."""
    return client.post("/v1/renders", json=body(seed), headers={"Idempotency-Key": key})


def look(client: httpx.Client, folder: Path, witness: Witness) -> None:
    """See which of the accepted renders are done."""
    for seed, link in witness.accepted.items():
        if seed not in witness.done and client.get(link).json()["state"] == "done":
            witness.done[seed] = begun(folder)[seed]


def live(
    folder: Path, renderer: str, witness: Witness, seeds: list[int], life_s: float, until_one: bool
) -> None:
    """Start the service, ask for renders, and kill it after a while.

    If `until_one`, it lives at least until one of its renders was seen to be done.
    """
    with (
        service(folder, renderer) as (process, address),
        httpx.Client(base_url=address, timeout=5) as client,
    ):
        while renderer == "scene" and not client.get("/readyz").is_success:
            time.sleep(0.02)
        end, known = time.monotonic() + life_s, len(witness.done)
        waiting = [*witness.unheard, *seeds]
        witness.unheard |= set(seeds)
        while time.monotonic() < end or (until_one and len(witness.done) == known):
            with suppress(httpx.TransportError):
                if waiting:
                    answer = post(client, waiting[0], f"key-{waiting[0]}")
                    assert answer.status_code == 202, answer.text
                    witness.accepted[waiting[0]] = answer.json()["links"]["self"]
                    witness.unheard.discard(waiting.pop(0))
                else:
                    look(client, folder, witness)
            if end - time.monotonic() > 0.02:
                time.sleep(0.01)
        process.kill()
        process.wait()


def die_young(folder: Path, renderer: str, life_s: float) -> None:
    """Start the service, and kill it whether it has come up or not."""
    command = [sys.executable, "-m", "bench.crash_service", str(folder), renderer]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL) as process:
        time.sleep(life_s)
        process.kill()


def pictures(address: str, links: dict[int, str]) -> dict[int, bytes | str]:
    """Wait for renders; returns their pictures, or why there is none."""
    found: dict[int, bytes | str] = {}
    end = time.monotonic() + PATIENCE_S
    with httpx.Client(base_url=address, timeout=60) as client:
        for seed, link in links.items():
            while (known := client.get(link).json())["state"] in ("queued", "running"):
                assert time.monotonic() < end, f"{link} is {known['state']} after {PATIENCE_S} s"
                time.sleep(0.02)
            if known["state"] == "done":
                found[seed] = client.get(f"{link}/image?format=png").content
            else:
                found[seed] = f"{known['state']}: {known['error']}"
    return found


def undisturbed(folder: Path, renderer: str, seeds: list[int]) -> dict[int, bytes | str]:
    """The pictures of a service that nobody kills."""
    with service(folder, renderer) as (_, address):
        with httpx.Client(base_url=address, timeout=60) as client:
            posted = {seed: post(client, seed, f"key-{seed}") for seed in seeds}
        return pictures(
            address, {seed: answer.json()["links"]["self"] for seed, answer in posted.items()}
        )


def crash_rounds(folder: Path, rounds: int, renderer: str, seed: int) -> dict[str, Any]:
    """Kill a service so often; returns counts, and the list of its broken words."""
    chance, witness = random.Random(seed), Witness()
    killed, calm = folder / "killed", folder / "calm"
    for number in range(rounds):
        seeds = list(range(number * RENDERS, (number + 1) * RENDERS))
        if number % STILLBORN == STILLBORN - 1:
            die_young(killed, renderer, chance.uniform(0.0, LONGEST_BIRTH_S))
        life_s = chance.uniform(0.0, LONGEST_LIFE_S[renderer])
        live(killed, renderer, witness, seeds, life_s, until_one=number % STILLBORN == 0)
    with service(killed, renderer) as (_, address):
        found = pictures(address, witness.accepted)
        before = begun(killed)
        with httpx.Client(base_url=address, timeout=60) as client:
            again = {seed: post(client, seed, f"again-{seed}").json() for seed in found}
    truth = undisturbed(calm, renderer, list(found))
    drafts = [path for path in killed.glob("*/incoming/*")]
    crashed = [seed for seed, picture in found.items() if str(picture).startswith("failed")]
    broken = [
        *(f"{n} is {found[n]!r:.200}" for n in found if n not in crashed and found[n] != truth[n]),
        *(f"{n} was begun again" for n, times in witness.done.items() if before[n] != times),
        *(
            f"{n} is {job['state']} the second time"
            for n, job in again.items()
            if n not in crashed and job["state"] != "done"
        ),
        *(f"{path} was left" for path in drafts),
        *(f"{n}: {found[n]}" for n in crashed if "process ended 3 times" not in str(found[n])),
    ]
    if len(crashed) > LARGEST_CRASHED_SHARE * len(found):
        broken.append(f"{len(crashed)} of {len(found)} were given up")
    return {
        "rounds": rounds,
        "renderer": renderer,
        "accepted": len(witness.accepted),
        "seen_done_before_a_kill": len(witness.done),
        "begun_more_than_once": sum(1 for times in before.values() if times > 1),
        "killed_three_times": len(crashed),
        "broken": broken,
    }


def main() -> None:
    """Kill, and say what came of it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=50)
    parser.add_argument("--renderer", choices=("pattern", "scene"), default="pattern")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        told = crash_rounds(Path(folder), options.rounds, options.renderer, options.seed)
    sys.stdout.write(json.dumps(told, indent=2) + "\n")
    sys.exit(1 if told["broken"] else 0)


if __name__ == "__main__":
    main()
