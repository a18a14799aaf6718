"""The park with each way of smoothing edges, against all samples of all pixels shaded.

    python -m bench.anti_aliasing [--size WxH] [--samples N] [--repeats N] [--picture OUT.png]

Prints a Markdown table: FLIP to `full`, root mean square difference of what is displayed, pixels
that were flagged, and seconds: the median of frames taken in turn. The picture shows a part of the
frame in each way, enlarged, and the pixels that `edges` has flagged.
"""

import argparse
import statistics
import sys
from pathlib import Path

import numpy as np
from PIL import Image

import raysvc
from raysvc.compare.picture_difference import picture_difference
from raysvc.types import Bytes

WAYS = ("none", "directional", "edges", "full")
PART = (0.54, 0.17, 0.635, 0.32)
"""Left, top, right and bottom of what is enlarged, as parts of the frame."""
ENLARGED = 4


def main() -> None:
    """Measure, and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--size", default="1280x720")
    parser.add_argument("--samples", type=int, default=16)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--picture", type=Path)
    arguments = parser.parse_args()
    width, height = (int(number) for number in arguments.size.split("x"))

    scene = raysvc.load("builtin:torus_park")
    view = {"gltf_camera": 0, "width": width, "height": height}
    seconds: dict[str, list[float]] = {way: [] for way in WAYS}
    frames: dict[str, raysvc.Frame] = {}
    raysvc.render(scene, camera=view, settings={"aa": "none"})
    for _ in range(arguments.repeats):
        for way in WAYS:
            settings = {"aa": way, "aa_samples": arguments.samples}
            frames[way] = raysvc.render(scene, camera=view, settings=settings)
            seconds[way].append(frames[way].statistics.total_seconds)

    full = frames["full"].layers["beauty"]
    say("| `aa` | FLIP | RMSE of 8 bits | pixels flagged | seconds, frame |")
    say("|---|--:|--:|--:|--:|")
    for way, frame in frames.items():
        found = picture_difference(frame.layers["beauty"], full, "pbr_neutral", 0.0)
        apart = found.picture.astype(np.float64) - found.reference
        say(
            f"| `{way}` | {found.figures.flip:.4f} | {np.sqrt(np.square(apart).mean()):.1f} "
            f"| {frame.statistics.edge_fraction:.1%} | {statistics.median(seconds[way]):.2f} |"
        )
    if arguments.picture is not None:
        Image.fromarray(enlarged(frames)).save(arguments.picture, optimize=True)


def enlarged(frames: dict[str, raysvc.Frame]) -> Bytes:
    """(H, W, 3) uint8: a part of each frame side by side, and of the mask of what was flagged."""
    mask = (255 * frames["edges"].layers["edge"]).astype(np.uint8)
    pictures = [frames[way].display()[..., :3] for way in WAYS]
    pictures.append(np.repeat(mask[..., None], 3, axis=2))
    height, width = mask.shape
    columns = slice(round(PART[0] * width), round(PART[2] * width))
    rows = slice(round(PART[1] * height), round(PART[3] * height))
    row = np.hstack([picture[rows, columns] for picture in pictures])
    return np.repeat(np.repeat(row, ENLARGED, axis=0), ENLARGED, axis=1)


def say(line: str) -> None:
    """Print a line."""
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
