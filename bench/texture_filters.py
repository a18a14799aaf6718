"""A chequerboard reflected in a torus: texture filters against 256 samples per pixel.

    python -m bench.texture_filters [--size WxH] [--picture OUT.png]

Prints a Markdown table. One sample per pixel, taken at its centre, is filtered by each of the
filters; the truth is the mean of 256 samples that read the texture at points (64 in each quarter of
a pixel: `aa=full` with `aa_samples=64` and `bilinear`, at twice the size). Only what the torus
reflects of the boards is compared: pixels of which all of 16 parts show a board in the torus.
Errors are of linear radiance, where white is 1.
"""

import argparse
import sys
import time
from contextlib import ExitStack
from pathlib import Path
from unittest import mock

import numpy as np
from PIL import Image

import raysvc
from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import sheet, torus
from raysvc.frame import points, primary
from raysvc.imaging.srgb import srgb_from_linear
from raysvc.scene import Camera, Material, Scene, Texture, TextureRef
from raysvc.tracing.differentials import primary_differentials
from raysvc.tracing.ray_differentials import RayDifferentials
from raysvc.types import Bools, Bytes, Floats

FILTERS = ("nearest", "bilinear", "mip", "sat", "ewa")
WIDTHS = (0.8, 0.9, 1.0, 1.1, 1.2, 1.5)
"""Of footprints, in pixels, that are tried."""
CAMERA = {"eye": [0.0, 2.2, 4.4], "target": [0.0, 1.45, 0.0], "fov_y_deg": 36}
PLAIN = {"occlusion_samples": 0, "shadows": False, "lens": "none", "tone_map": "linear"}
TRUTH = {"aa": "full", "texture_filter": "bilinear"}
SAMPLES = 64
"""In each quarter of a pixel."""
BOARD_SIZE = 60.0
FIELDS = 16
"""Fields of the board along a side of its texture, which is repeated."""
TEXELS = 512
REPEATS = 3
CEILING = 5.0
"""Height of the second board in metres."""
TORUS = 1
"""Its material."""


def main() -> None:
    """Measure, and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--size", default="240x180")
    parser.add_argument("--picture", type=Path)
    arguments = parser.parse_args()
    width, height = (int(number) for number in arguments.size.split("x"))

    scene = torus_over_board()
    truth = true_radiance(scene, width, height)
    compared = board_pixels(width, height)
    lines = [
        f"{compared.sum():,} pixels of {width} x {height}",
        "",
        "| filter | mean absolute error | root mean square error | seconds |",
        "|---|---|---|---|",
    ]
    shown = {"256 samples": truth}
    for name in FILTERS:
        seconds, radiance = rendered(scene, width, height, name)
        absolute, square = errors(radiance, truth, compared)
        lines.append(f"| `{name}` | {absolute:.4f} | {square:.4f} | {seconds:.2f} |")
        shown[name] = radiance
    lines += ["", "| width of a pixel's step | `sat` | `ewa` |", "|---|---|---|"]
    for width_px in WIDTHS:
        row = [
            errors(rendered(scene, width, height, name, width_px)[1], truth, compared)[1]
            for name in ("sat", "ewa")
        ]
        lines.append(f"| {width_px} | {row[0]:.4f} | {row[1]:.4f} |")
    sys.stdout.write("\n".join(lines) + "\n")
    if arguments.picture:
        picture([shown[name] for name in ("bilinear", "mip", "sat", "ewa", "256 samples")]).save(
            arguments.picture, optimize=True
        )


def torus_over_board() -> Scene:
    """A mirror in the shape of a torus between two boards that glow by themselves."""
    row, col = np.indices((TEXELS, TEXELS)) // (TEXELS // FIELDS)
    texels = np.full((TEXELS, TEXELS, 4), 255, np.uint8)
    texels[(row + col) % 2 == 1, :3] = 0
    return _scene(texels)


def _scene(texels: Bytes) -> Scene:
    board = Material("board", unlit=True, base_colour_texture=TextureRef(0), double_sided=True)
    mirror = Material("mirror", metallic=1.0, roughness=0.0)
    floor = sheet(BOARD_SIZE, BOARD_SIZE, 1, 1).textured(REPEATS, REPEATS)
    ring = torus(1.0, 0.45, 120, 60_000).turned(62, 0).turned(20, 1).moved([0, 1.5, 0])
    return scene_of(
        "torus over a board",
        [Part(floor, 0), Part(floor.moved([0, CEILING, 0]), 0), Part(ring, TORUS)],
        [board, mirror],
        textures=[Texture(texels)],
    )


def rendered(
    scene: Scene, width: int, height: int, name: str, width_px: float = 1.0
) -> tuple[float, Floats]:
    """Seconds, and linear radiance (H, W, 3) with one sample per pixel, by one filter.

    With `width_px` other than 1 footprints are so many pixels wide.
    """
    settings = PLAIN | {"aa": "none", "texture_filter": name}
    view = CAMERA | {"width": width, "height": height}

    def widened(camera: Camera, directions: Floats, _: float = 1.0) -> RayDifferentials:
        return primary_differentials(camera, directions, width_px)

    with ExitStack() as stack:
        for module in (points, primary):
            stack.enter_context(mock.patch.object(module, "primary_differentials", widened))
        raysvc.render(scene, _dark(), view, settings)
        start = time.perf_counter()
        frame = raysvc.render(scene, _dark(), view, settings)
        return time.perf_counter() - start, frame.layers["beauty"][..., :3]


def true_radiance(scene: Scene, width: int, height: int, samples: int = SAMPLES) -> Floats:
    """Linear radiance (H, W, 3), the mean of 4 x `samples` per pixel that read single points."""
    view = CAMERA | {"width": 2 * width, "height": 2 * height}
    frame = raysvc.render(scene, _dark(), view, PLAIN | TRUTH | {"aa_samples": samples})
    return _quarters(frame.layers["beauty"][..., :3]).mean(axis=(1, 3), dtype=np.float32)


def board_pixels(width: int, height: int) -> Bools:
    """(H, W) pixels whose 16 parts all show the torus, and a board in it: not what is beside it.

    The same scene with white boards in a black world says which.
    """
    view = CAMERA | {"width": 4 * width, "height": 4 * height}
    white = _scene(np.full((1, 1, 4), 255, np.uint8))
    frame = raysvc.render(white, _dark(), view, PLAIN | {"aa": "none"})
    on_torus = frame.layers["material"] == TORUS
    bright = frame.layers["beauty"][..., 0] > 0.99
    shows: Bools = (on_torus & bright).reshape(height, 4, width, 4).all(axis=(1, 3))
    return shows


def errors(radiance: Floats, truth: Floats, compared: Bools) -> tuple[float, float]:
    """Mean absolute and root mean square difference over pixels and channels."""
    difference = (radiance - truth)[compared].astype(np.float64)
    return float(np.abs(difference).mean()), float(np.sqrt((difference**2).mean()))


def picture(radiances: list[Floats]) -> Image.Image:
    """The torus by each of the filters side by side, without what is left and right of it."""
    margin = radiances[0].shape[1] // 8
    parts = [srgb_from_linear(np.clip(r[:, margin:-margin], 0.0, 1.0)) for r in radiances]
    return Image.fromarray((np.hstack(parts) * 255 + 0.5).astype(np.uint8))


def _dark() -> raysvc.Environment:
    return raysvc.Environment(np.zeros((8, 16, 3), np.float32), name="dark")


def _quarters(values: Floats) -> Floats:
    height, width = values.shape[:2]
    return values.reshape(height // 2, 2, width // 2, 2, -1)


if __name__ == "__main__":
    main()
