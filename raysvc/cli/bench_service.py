"""`raysvc bench service`: what the service itself costs."""

import json
import tempfile
from pathlib import Path
from typing import Annotated, Any

import typer

from raysvc.cli.arguments import writable
from raysvc.cli.progress import progress_bar
from raysvc.cli.service_trial import load, memory, overhead, service_on_trial
from raysvc.cli.tables import bench_table, show
from raysvc.compare.machine import machine
from raysvc.version import VERSION


def service(
    output: Annotated[Path | None, typer.Option("--json", help="A file for the results.")] = None,
    rounds: Annotated[
        int, typer.Option("--rounds", min=1, max=1000, help="Renders that are timed.")
    ] = 20,
    clients: Annotated[
        int, typer.Option("--clients", min=1, max=1000, help="Of the load, all at once.")
    ] = 64,
    seconds: Annotated[
        float, typer.Option("--seconds", min=0, max=3600, help="Of the load; 0 for none.")
    ] = 5.0,
    renders: Annotated[
        int, typer.Option("--renders", min=0, max=100_000, help="To watch memory; 0 for none.")
    ] = 100,
) -> None:
    """Measure a start, what HTTP and the job add to a render, a load, and how memory grows."""
    if output is not None:
        writable(output, "--json")
    results: list[dict[str, Any]] = []
    with progress_bar("bench service") as report, tempfile.TemporaryDirectory() as folder:
        report("start", 0.0)
        # The first start fills the cache of kernels.
        with service_on_trial(Path(folder, "first")) as (_, _, first):
            pass
        with service_on_trial(Path(folder, "second")) as (client, process, took):
            results.append({"measured": "start", "first_ready_s": first["ready_s"], **took})
            results.append(overhead(client, rounds, report))
            if renders:
                results.append(memory(client, process, renders, report))
            if seconds:
                results.append(load(client, clients, seconds, report))
    if output is not None:
        measured = {"machine": machine(), "version": VERSION, "results": results}
        output.write_text(json.dumps(measured, indent=2) + "\n", encoding="utf-8")
    for result in results:
        show(bench_table([result]))
