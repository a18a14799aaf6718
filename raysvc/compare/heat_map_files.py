"""Heat maps as pictures for people, and as counts for programs."""

from collections.abc import Mapping

import numpy as np

from raysvc.compare.heat_map import HeatMap
from raysvc.compare.picture import DOTS_PER_INCH, encoded, figure
from raysvc.imaging.encode_layers import encode_exr

NARROWEST_IN, WIDEST_IN = 4.2, 12.0
"""Of a map; between them a pixel of it is about a pixel of the picture."""
BRIGHTEST_PERCENTILE = 99.5
"""What is more costly than this many percent of the pixels is shown as the brightest."""


def heat_maps_exr(maps: Mapping[str, HeatMap]) -> bytes:
    """OpenEXR of the counts: channels `NAME.node_steps.V` and `NAME.triangle_tests.V`."""
    layers = {}
    for name, costs in maps.items():
        plain = name.replace(", ", "_").replace(" ", "_")
        layers[f"{plain}.node_steps"] = costs.node_steps
        layers[f"{plain}.triangle_tests"] = costs.triangle_tests
    return encode_exr(layers)


def heat_maps_png(maps: Mapping[str, HeatMap]) -> bytes:
    """PNG: a row for each structure, steps on the left, tests on the right, one scale for each."""
    height, width = next(iter(maps.values())).node_steps.shape
    panel_in = min(max(width / DOTS_PER_INCH, NARROWEST_IN), WIDEST_IN)
    picture = figure(2 * panel_in + 1.6, len(maps) * (panel_in * height / width + 0.45))
    axes = picture.subplots(len(maps), 2, squeeze=False)
    for column, (field, title) in enumerate(
        (("node_steps", "node steps"), ("triangle_tests", "triangle tests"))
    ):
        counts = {name: getattr(costs, field) for name, costs in maps.items()}
        top = max(float(np.percentile(c, BRIGHTEST_PERCENTILE)) for c in counts.values())
        for row, (name, array) in enumerate(counts.items()):
            panel = axes[row, column]
            shown = panel.imshow(array, cmap="inferno", vmin=0.0, vmax=max(top, 1.0))
            panel.set_axis_off()
            panel.set_title(f"{name}: {title}, {float(array.mean()):.1f} per ray", fontsize=10)
            bar = picture.colorbar(shown, ax=panel, fraction=0.03, pad=0.02, extend="max")
            bar.set_label(f"{title} of a pixel's ray")
    return encoded(picture, "png")
