"""Tables for people."""

from collections.abc import Mapping, Sequence
from typing import Any

from rich.table import Table


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
