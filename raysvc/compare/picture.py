"""Figures without a display, and the same bytes for the same numbers."""

import io
import threading
from typing import Final, Literal

import matplotlib
from matplotlib.figure import Figure

ChartFormat = Literal["svg", "png"]
CHART_FORMATS: Final[tuple[ChartFormat, ...]] = ("svg", "png")
DOTS_PER_INCH: Final = 110

_ONE_AT_A_TIME = threading.Lock()
"""Matplotlib's settings are global."""


def figure(width_in: float, height_in: float) -> Figure:
    """An empty figure of so many inches."""
    return Figure(figsize=(width_in, height_in), dpi=DOTS_PER_INCH, layout="constrained")


def encoded(picture: Figure, format: ChartFormat) -> bytes:
    """A file of a figure; ids in an SVG are seeded, and there is no date or version in it."""
    out = io.BytesIO()
    dated = {"Date": None, "Creator": None} if format == "svg" else {"Software": None}
    with _ONE_AT_A_TIME, matplotlib.rc_context({"svg.hashsalt": "raysvc"}):
        picture.savefig(out, format=format, metadata=dated)
    return out.getvalue()
