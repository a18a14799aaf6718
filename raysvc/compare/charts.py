"""A comparison as bars and curves, for people."""

from collections.abc import Callable, Sequence
from typing import Any

from matplotlib.axes import Axes

from raysvc.compare.contenders import label_of
from raysvc.compare.picture import ChartFormat, encoded, figure
from raysvc.compare.result import Comparison, Scaling, StructureFigures

COLOURS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#999933", "#555555")
"""Okabe and Ito: told apart by colour-blind people too."""
PANEL_WIDTH_IN, PANEL_HEIGHT_IN = 5.6, 3.0
Figure_ = Callable[[StructureFigures], float | None]


def chart(comparison: Comparison, format: ChartFormat) -> bytes:
    """Build time, memory, speed and steps of every structure; and scaling, if it was measured."""
    panels: list[tuple[str, str, Sequence[tuple[str, Figure_]]]] = [
        ("Build time", "ms", [("", lambda s: s.build.build_ms)]),
        ("Memory", "MiB", [("", lambda s: s.build.tree_mib)]),
        (
            "Speed",
            "Mrays/s",
            [
                ("one thread", lambda s: s.traversal.mrays_per_s_one_thread),
                (f"{comparison.threads} threads", lambda s: s.traversal.mrays_per_s_all_threads),
            ],
        ),
        (
            "Steps and tests",
            "per ray",
            [
                ("node steps", lambda s: s.traversal.node_steps_per_ray),
                ("triangle tests", lambda s: s.traversal.triangle_tests_per_ray),
            ],
        ),
    ]
    bars = len(comparison.structures)
    height = max(PANEL_HEIGHT_IN, 0.9 + 0.36 * bars)
    lines = 3 if comparison.scaling is not None else 2
    picture = figure(2 * PANEL_WIDTH_IN, lines * height + 0.4)
    axes = picture.subplots(lines, 2, squeeze=False)
    rays = comparison.rays
    picture.suptitle(
        f"{comparison.scene}: {comparison.triangles:,} triangles, {rays.count:,} {rays.kind} rays"
    )
    for place, (title, unit, values) in enumerate(panels):
        _bars(axes[place // 2, place % 2], comparison.structures, title, unit, values)
    if comparison.scaling is not None:
        _scaling(axes[2], comparison.scaling)
    return encoded(picture, format)


def _bars(
    axes: Axes,
    structures: Sequence[StructureFigures],
    title: str,
    unit: str,
    values: Sequence[tuple[str, Figure_]],
) -> None:
    """A group of bars for each structure, the first on top; what cannot be seen has none."""
    thick = 0.8 / len(values)
    top = max((value(s) or 0.0 for _, value in values for s in structures), default=0.0) or 1.0
    for number, (label, value) in enumerate(values):
        for row, structure in enumerate(structures):
            at = row + (number - (len(values) - 1) / 2) * thick
            length = value(structure)
            axes.barh(
                at,
                length or 0.0,
                0.92 * thick,
                color=COLOURS[number],
                label=label if row == 0 and label else None,
            )
            text = "not seen" if length is None else f"{length:,.{0 if length >= 100 else 2}f}"
            axes.text((length or 0.0) + 0.01 * top, at, text, va="center", fontsize=8)
    labels = [label_of(s.name, s.trees).replace(", ", "\n") for s in structures]
    axes.set_yticks(range(len(structures)), labels)
    axes.invert_yaxis()
    axes.set_xlim(0.0, 1.16 * top)
    axes.set_title(title, fontsize=11)
    axes.set_xlabel(unit, loc="right")
    _bare(axes)
    if len(values) > 1:
        axes.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=2)


def _scaling(axes: Any, scaling: Scaling) -> None:
    """Speed by triangles, and by threads."""
    names = list(dict.fromkeys(point.name for point in scaling.triangles))
    for number, name in enumerate(names):
        colour = COLOURS[number % len(COLOURS)]
        some = [point for point in scaling.triangles if point.name == name]
        axes[0].plot(
            [point.triangles for point in some],
            [point.mrays_per_s_one_thread for point in some],
            marker="o",
            color=colour,
            label=name,
        )
        asked = [point for point in scaling.threads if point.name == name]
        axes[1].plot(
            [point.threads for point in asked],
            [point.mrays_per_s for point in asked],
            marker="o",
            color=colour,
            label=name,
        )
    axes[0].set_xscale("log", base=2)
    counts = sorted({point.triangles for point in scaling.triangles})
    axes[0].set_xticks(counts, [f"{count:,}" for count in counts])
    axes[0].minorticks_off()
    threads = sorted({point.threads for point in scaling.threads})
    axes[1].set_xticks(threads)
    for panel, title, unit in (
        (axes[0], "One thread, parts of the triangles", "triangles"),
        (axes[1], "All triangles, by threads", "threads"),
    ):
        panel.set_title(title, fontsize=11)
        panel.set_xlabel(unit, loc="right")
        panel.set_ylabel("Mrays/s")
        panel.set_ylim(bottom=0.0)
        panel.legend(fontsize=7, loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=2)
        _bare(panel)


def _bare(axes: Axes) -> None:
    """No frame where there is nothing to read off."""
    axes.spines[["top", "right"]].set_visible(False)
