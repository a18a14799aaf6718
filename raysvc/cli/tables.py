"""Tables for people."""

from collections.abc import Mapping, Sequence
from typing import Any

from rich.console import Console
from rich.table import Table

from raysvc.compare.contenders import label_of
from raysvc.compare.result import Comparison

WIDE = 160
"""Columns where nobody's terminal says how many there are: a table in a file is not cut."""


def show(table: Table) -> None:
    """Print a table to standard output."""
    console = Console()
    if not console.is_terminal:
        console.width = WIDE
    console.print(table)


def stage_table(statistics: Mapping[str, Any]) -> Table:
    """Seconds per stage of a render, their share of the whole, and the rays."""
    total = statistics["total_seconds"]
    rows = [
        (stage["name"], f"{stage['seconds']:.3f}", f"{100 * stage['seconds'] / total:.0f} %")
        for stage in statistics["stages"]
        if total > 0
    ]
    table = plain_table(("stage", "seconds", "share"), rows, numbers=(1, 2))
    table.add_section()
    table.add_row("total", f"{total:.3f}", "")
    table.add_section()
    for kind, count in statistics.get("rays", {}).items():
        table.add_row(f"{kind} rays", f"{count:,}", "")
    return table


def comparison_table(comparison: Comparison) -> Table:
    """What matters most of every structure; the files hold the rest."""
    rows = [
        (
            label_of(structure.name, structure.trees),
            f"{structure.build.build_ms:,.0f}",
            _number(structure.build.tree_mib, 2),
            _number(structure.traversal.node_steps_per_ray, 1),
            _number(structure.traversal.triangle_tests_per_ray, 1),
            _number(structure.traversal.mrays_per_s_one_thread, 2),
            _number(structure.traversal.mrays_per_s_all_threads, 2),
            f"{structure.traversal.hits:,}",
        )
        for structure in comparison.structures
    ]
    table = plain_table(
        ("structure", "build ms", "MiB", "steps", "tests", "Mrays/s", "all threads", "hits"),
        rows,
        numbers=range(1, 8),
    )
    rays = comparison.rays
    table.title = f"{comparison.scene}: {rays.count:,} {rays.kind} rays"
    return table


def bench_table(results: Sequence[Mapping[str, Any]], digits: int = 3) -> Table:
    """A row for each result of a benchmark, a column for each of its names."""
    columns = list(results[0])
    rows = [
        [_number(value, digits) if isinstance(value, float) else value for value in result.values()]
        for result in results
    ]
    numbers = [place for place, name in enumerate(columns) if isinstance(results[0][name], float)]
    return plain_table(columns, rows, numbers)


def sat_tables(results: Sequence[Mapping[str, Any]]) -> list[Table]:
    """A table for each kind of result of summed-area tables, by what was measured."""
    groups: dict[str, list[Mapping[str, Any]]] = {}
    for result in results:
        shown = {name: value for name, value in result.items() if name != "measured"}
        groups.setdefault(result["measured"], []).append(shown)
    tables = []
    for measured, group in groups.items():
        table = bench_table(group, digits=4)
        table.title = measured
        tables.append(table)
    return tables


def difference_table(compared: Mapping[str, Any]) -> Table:
    """A hybrid picture against its reference."""
    rows = [
        ("FLIP", f"{compared['flip']:.4f}"),
        ("HDR-FLIP", f"{compared['hdr_flip']:.4f}"),
        ("relMSE", f"{compared['rel_mse']:.4f}"),
        ("relMSE, trimmed", f"{compared['rel_mse_trimmed']:.4f}"),
        ("mean ratio", _number(compared["mean_ratio"], 4)),
        ("seconds", f"{compared['seconds']:.2f}"),
        ("seconds of the reference", f"{compared['reference_seconds']:.2f}"),
    ]
    table = plain_table(("hybrid against reference", ""), rows, numbers=(1,))
    where = f"{compared['scene']}, {compared['environment']}"
    table.title = f"{where}, {compared['width']}x{compared['height']}"
    return table


def frame_tables(results: Sequence[Mapping[str, Any]]) -> list[Table]:
    """A table for each scene and series of frames: what is varied beside each other, seconds,
    stages and rays below."""
    groups: dict[tuple[str, str], list[Mapping[str, Any]]] = {}
    for result in results:
        groups.setdefault((result["scene"], result["series"]), []).append(result)
    return [_frame_table(scene, series, points) for (scene, series), points in groups.items()]


def _frame_table(scene: str, series: str, points: Sequence[Mapping[str, Any]]) -> Table:
    """One series; what is the same in all of it is the title."""
    stages = [{each["name"]: each["seconds"] for each in point["stages"]} for point in points]
    kinds = list(dict.fromkeys(kind for point in points for kind in point["rays"]))
    columns = [series, *(point["point"] for point in points)]
    table = plain_table(columns, [], numbers=range(1, len(columns)))
    table.add_row("seconds", *(f"{point['seconds']:.3f}" for point in points))
    table.add_row("between quartiles", *(f"{point['iqr']:.3f}" for point in points))
    table.add_section()
    for name in stages[0]:
        table.add_row(name, *(f"{seconds[name]:.3f}" for seconds in stages))
    table.add_section()
    for kind in kinds:
        table.add_row(f"{kind} rays", *(f"{point['rays'].get(kind, 0):,}" for point in points))
    table.add_row("edge pixels", *(f"{100 * point['edge_fraction']:.1f} %" for point in points))
    facts = [
        {f"{point['width']}x{point['height']}" for point in points},
        {f"{point['triangles']:,} triangles" for point in points},
        {f"{point['threads']} threads" for point in points},
    ]
    table.title = ", ".join([scene, *(each.pop() for each in facts if len(each) == 1)])
    return table


def _number(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:,.{digits}f}"


def plain_table(
    columns: Sequence[str], rows: Sequence[Sequence[Any]], numbers: Sequence[int] = ()
) -> Table:
    """A table of texts; the columns in `numbers` are flush right."""
    table = Table()
    for index, name in enumerate(columns):
        table.add_column(name, justify="right" if index in numbers else "left")
    for row in rows:
        table.add_row(*(str(cell) for cell in row))
    return table
