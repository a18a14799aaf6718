"""Heat maps as pictures for people, and as counts for programs."""

from collections.abc import Mapping

import numpy as np

from raysvc.compare.heat_map import HeatMap
from raysvc.compare.picture import encoded, figure
from raysvc.imaging.encode_layers import encode_exr

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
    inches = (2 * 6.4 + 1.6, len(maps) * (6.4 * height / width + 0.45))
    picture = figure(*inches)
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
