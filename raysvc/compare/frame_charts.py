"""Series of frames as small multiples: seconds on the left, what they were spent on beside them."""

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes

from raysvc.compare.charts import COLOURS
from raysvc.compare.picture import ChartFormat, encoded, figure

Point = Mapping[str, Any]

PANEL_WIDTH_IN, PANEL_HEIGHT_IN, LEGEND_IN = 4.4, 2.7, 1.3
LEAST_SHARE: Final = 0.002
"""A stage that never takes so much of a frame is not shown."""
GREYS: Final = ("0.1", "0.4", "0.6", "0.75")
MARKERS: Final = "os^Dv*"
"""Scenes are told apart by greys and markers, so that colours are the stages' alone."""
HATCHES: Final = ("", "///", "...")
"""For stages beyond the number of colours."""
AXIS: Final = {
    "stages": "seconds",
    "bounces": "bounces",
    "resolution": "million pixels",
    "triangles": "million triangles",
    "threads": "threads",
}


def frame_chart(measured: Mapping[str, Any], format: ChartFormat) -> bytes:
    """Draw what `bench_frame` returns: a row for each series, a curve and a panel of shares for
    each scene."""
    results: Sequence[Point] = measured["results"]
    scenes = list(dict.fromkeys(point["scene"] for point in results))
    rows = list(dict.fromkeys(point["series"] for point in results))
    stages = _shown_stages(results)
    width = (1 + len(scenes)) * PANEL_WIDTH_IN + LEGEND_IN
    picture = figure(width, len(rows) * PANEL_HEIGHT_IN + 0.4)
    axes = picture.subplots(len(rows), 1 + len(scenes), squeeze=False)
    for row, series in enumerate(rows):
        by_scene = {
            name: [p for p in results if p["scene"] == name and p["series"] == series]
            for name in scenes
        }
        if series == "stages":
            _bars(axes[row, 0], by_scene, stages)
        else:
            _curves(axes[row, 0], series, by_scene)
        for column, (name, points) in enumerate(by_scene.items(), start=1):
            _shares(axes[row, column], series, points, stages)
            if row == 0:
                axes[row, column].set_title(f"{name}: shares of the stages", fontsize=10)
    axes[0, -1].legend(fontsize=8, loc="upper left", bbox_to_anchor=(1.01, 1.0), reverse=True)
    picture.suptitle(f"A warm frame, median of {measured['rounds']} rounds")
    return encoded(picture, format)


def _shown_stages(results: Sequence[Point]) -> list[str]:
    """Stages in their order, without those that take next to nothing."""
    most: dict[str, float] = {}
    for point in results:
        for stage in point["stages"]:
            share = stage["seconds"] / point["seconds"]
            most[stage["name"]] = max(most.get(stage["name"], 0.0), share)
    return [name for name, share in most.items() if share >= LEAST_SHARE]


def _seconds(point: Point, stage: str) -> float:
    return float(sum(each["seconds"] for each in point["stages"] if each["name"] == stage))


def _varied(series: str, point: Point) -> float:
    """What a series varies, as a number for an axis."""
    if series == "resolution":
        return float(point["width"] * point["height"] / 1e6)
    if series == "triangles":
        return float(point["triangles"] / 1e6)
    return float(point["threads"] if series == "threads" else point["settings"]["bounces"])


def _curves(axes: Axes, series: str, by_scene: Mapping[str, Sequence[Point]]) -> None:
    """Seconds over what is varied; for threads also what as many would take at best."""
    top = 0.0
    for number, (name, points) in enumerate(by_scene.items()):
        grey, marker = GREYS[number % len(GREYS)], MARKERS[number % len(MARKERS)]
        at = [_varied(series, point) for point in points]
        seconds = [point["seconds"] for point in points]
        axes.plot(at, seconds, marker=marker, color=grey, label=name)
        top = max(top, *seconds)
        if series == "threads":
            some = np.linspace(at[0], at[-1], 100)
            label = "one thread's time shared out" if number == 0 else None
            axes.plot(some, seconds[0] * at[0] / some, linestyle=":", color=grey, label=label)
    if series in ("bounces", "threads"):
        axes.set_xticks(sorted({_varied(series, p) for some in by_scene.values() for p in some}))
    axes.set_ylim(0.0, 1.1 * top)
    if series != "threads":
        axes.set_xlim(left=min(0.0, axes.get_xlim()[0]))
    axes.set_xlabel(AXIS[series], loc="right")
    axes.set_ylabel("seconds")
    axes.legend(fontsize=7)
    axes.spines[["top", "right"]].set_visible(False)


def _bars(axes: Axes, by_scene: Mapping[str, Sequence[Point]], stages: Sequence[str]) -> None:
    """Seconds of every stage of the frame as it was asked for."""
    thick = 0.8 / len(by_scene)
    totals = [f"{name}: {points[0]['seconds']:.2f} s" for name, points in by_scene.items()]
    axes.set_title("\n".join(totals), fontsize=10)
    for number, (name, points) in enumerate(by_scene.items()):
        for row, stage in enumerate(stages):
            length = _seconds(points[0], stage)
            at = row + (number - (len(by_scene) - 1) / 2) * thick
            grey = GREYS[number % len(GREYS)]
            axes.barh(at, length, 0.92 * thick, color=grey, label=name if row == 0 else None)
            axes.text(length, at, f" {length:.2f}", va="center", fontsize=8)
    axes.set_yticks(range(len(stages)), stages)
    axes.invert_yaxis()
    axes.margins(x=0.15)
    axes.set_xlabel(AXIS["stages"], loc="right")
    if len(by_scene) > 1:
        axes.legend(fontsize=7, loc="lower right")
    axes.spines[["top", "right"]].set_visible(False)


def _shares(axes: Axes, series: str, points: Sequence[Point], stages: Sequence[str]) -> None:
    """A bar for each point, cut into the stages."""
    places = range(len(points))
    reached = [0.0] * len(points)
    for number, stage in enumerate(stages):
        shares = [100.0 * _seconds(point, stage) / point["seconds"] for point in points]
        again, colour = divmod(number, len(COLOURS))
        axes.bar(
            places,
            shares,
            bottom=reached,
            width=0.8,
            color=COLOURS[colour],
            hatch=HATCHES[again % len(HATCHES)],
            label=stage,
        )
        reached = [low + share for low, share in zip(reached, shares, strict=True)]
    axes.set_xticks(places, [point["point"] for point in points], fontsize=8)
    axes.set_xlim(-0.5, max(len(points), 3) - 0.5)
    axes.set_ylim(0.0, 100.0)
    axes.set_ylabel("% of a frame")
    if series != "stages":
        axes.set_xlabel(series, loc="right")
    axes.spines[["top", "right"]].set_visible(False)
