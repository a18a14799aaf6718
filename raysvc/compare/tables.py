"""A comparison as JSON, CSV and Markdown: the same numbers under the same names."""

import csv
import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Any, Final, Literal

from raysvc.compare.result import BuildFigures, Comparison, TraversalFigures
from raysvc.compare.talk_2009 import Talk

TableFormat = Literal["json", "csv", "md"]
TABLE_FORMATS: Final[tuple[TableFormat, ...]] = ("json", "csv", "md")
BUILD: Final = tuple(field.name for field in fields(BuildFigures))
TRAVERSAL: Final = tuple(field.name for field in fields(TraversalFigures))
TALK_2009: Final = "talk of 2009"
UNSEEN: Final = "-"
"""In Markdown; CSV leaves the cell empty, JSON has null."""


def table(comparison: Comparison, format: TableFormat) -> str:
    """Return a comparison as text in one of TABLE_FORMATS."""
    if format == "json":
        return json.dumps(comparison.to_dict(), indent=2, allow_nan=False) + "\n"
    return table_csv(comparison) if format == "csv" else table_markdown(comparison)


def table_csv(comparison: Comparison) -> str:
    """A row for each structure and kind of trees, and one for each of the talk's."""
    out = io.StringIO()
    rays = comparison.rays
    columns = ("source", "scene", "rays", "count", "seed", "name", "trees", *BUILD, *TRAVERSAL)
    writer = csv.DictWriter(out, columns, restval="", lineterminator="\n")
    writer.writeheader()
    for structure in comparison.structures:
        writer.writerow(
            {
                "source": "measured",
                "scene": comparison.scene,
                "rays": rays.kind,
                "count": rays.count,
                "seed": rays.seed,
                "name": structure.name,
                "trees": structure.trees,
                **{name: getattr(structure.build, name) for name in BUILD},
                **{name: getattr(structure.traversal, name) for name in TRAVERSAL},
            }
        )
    for row in comparison.talk_2009.structures if comparison.talk_2009 else ():
        known = {name: getattr(row, name) for name in BUILD if hasattr(row, name)}
        writer.writerow(
            {
                "source": TALK_2009,
                "scene": comparison.scene,
                "name": row.name,
                "trees": "per_material",
                **known,
                "stack_writes_per_step": row.writes_per_traversal,
            }
        )
    return out.getvalue()


def table_markdown(comparison: Comparison) -> str:
    """What was asked, the trees, their traversal, scaling if there is, the talk's figures."""
    rays, machine = comparison.rays, comparison.machine
    parts = [
        f"# {comparison.scene}: {rays.count:,} {rays.kind} rays\n",
        f"{comparison.triangles:,} triangles, {comparison.materials} materials; query "
        f"`{comparison.query}`, seed {rays.seed}; median of {comparison.rounds} rounds; all "
        f"threads are {comparison.threads}; {machine['processor']}, raysvc "
        f"{comparison.renderer_version}.\n",
        "## Build\n",
        _figures_table(comparison, "build", BUILD),
        "## Traversal\n",
        _figures_table(comparison, "traversal", TRAVERSAL),
        "\n".join(f"- `{name}`: {text}." for name, text in comparison.to_dict()["steps"].items())
        + "\n",
    ]
    if comparison.scaling is not None:
        for title, points in (
            ("Scaling with triangles", comparison.scaling.triangles),
            ("Scaling with threads", comparison.scaling.threads),
        ):
            columns = [field.name for field in fields(points[0])]
            rows = [[_shown(getattr(point, name)) for name in columns] for point in points]
            parts += [f"## {title}\n", markdown_table(columns, rows)]
    if comparison.talk_2009 is not None:
        parts.append(_talk_table(comparison, comparison.talk_2009))
    return "\n".join(parts)


def markdown_table(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table in Markdown, the first column flush left."""
    lines = [columns, ["---", *["--:"] * (len(columns) - 1)], *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def _figures_table(comparison: Comparison, part: str, names: Sequence[str]) -> str:
    """Structures side by side, a figure in each row: there are many figures and few structures."""
    structures = comparison.structures
    columns = ["", *(f"{s.name} ({s.trees})" for s in structures)]
    rows = []
    for name in names:
        values = [getattr(getattr(structure, part), name) for structure in structures]
        # A checksum is there to be compared to its last digit.
        rows.append([name, *map(str if name == "hit_checksum" else _shown, values)])
    return markdown_table(columns, rows)


def _talk_table(comparison: Comparison, talk: Talk) -> str:
    """The talk's figures, each beside ours of the same structure with one tree per material."""
    columns = ["", "nodes", "max_depth", "mean_depth", "triangle_references"]
    columns += ["triangles per leaf that is not empty", "tree_mib", "writes per step"]
    columns += ["steps relative to bvh", "time relative to bvh"]
    rows = []
    ours = {s.name: s for s in comparison.structures if s.trees == "per_material"}
    first = talk.structures[0]
    for theirs in talk.structures:
        values: list[Any] = [getattr(theirs, name) for name in columns[1:5]]
        values += [theirs.mean_triangles_per_leaf, theirs.tree_mib, theirs.writes_per_traversal]
        values += [theirs.traversals / first.traversals, theirs.time_s / first.time_s]
        rows.append([f"{theirs.name}, {TALK_2009}", *map(_shown, values)])
        if theirs.name in ours:
            build, asked = ours[theirs.name].build, ours[theirs.name].traversal
            values = [getattr(build, name) for name in columns[1:5]]
            values += [build.mean_triangles_per_nonempty_leaf, build.tree_mib]
            values += [asked.stack_writes_per_step, *_relative(ours, theirs.name)]
            rows.append([f"{theirs.name}, here", *map(_shown, values)])
    notes = "\n".join(f"- {note}" for note in talk.notes)
    heading = f"## Beside the talk of 2009\n\n{talk.source}.\n"
    return f"{heading}\n{markdown_table(columns, rows)}\n{notes}\n"


def _relative(ours: Mapping[str, Any], name: str) -> tuple[float | None, float | None]:
    """Steps and time of a structure per ray, in those of `bvh`."""
    if "bvh" not in ours:
        return None, None
    one, other = ours["bvh"].traversal, ours[name].traversal
    return (
        other.node_steps_per_ray / max(one.node_steps_per_ray, 1e-9),
        one.mrays_per_s_one_thread / other.mrays_per_s_one_thread,
    )


def _shown(value: Any) -> str:
    """A number for people: four digits, thousands apart, and whole numbers whole."""
    if value is None:
        return UNSEEN
    if isinstance(value, float):
        return f"{value:,.0f}" if abs(value) >= 10_000 else f"{value:.4g}"
    return f"{value:,}" if isinstance(value, int) else str(value)
