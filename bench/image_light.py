"""How near image-based light comes to brute-force integrals, and how fast it is.

    python -m bench.image_light [FOLDER OF .hdr AND .exr] [--picture OUT.png]

Prints Markdown tables; the picture shows spheres beside their brute-force integrals. The sun, where
a map has one, is a light of its own and left out on both sides.
"""

import argparse
import os
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import OpenImageIO
from PIL import Image

from bench.brute_force import outgoing
from raysvc.builtin import BUILTIN_ENVIRONMENTS
from raysvc.lighting.image_light import ImageLight
from raysvc.lighting.sphere_table import sphere_table
from raysvc.lighting.sun import LUMINANCE, extract_suns
from raysvc.scene import Environment
from raysvc.shading.coat import Coat
from raysvc.shading.glass import Glass
from raysvc.shading.surface import Surface
from raysvc.types import Doubles, Floats

MAPS = (
    "venice_sunset_1k.hdr",
    "studio_small_03_1k.hdr",
    "kloppenheim_05_1k.hdr",
    "KernerEnvLatLong.exr",
)
"""The places of the lookups were fitted on these, for other directions. The built-in ones were not
seen by the fit: they say what it is worth elsewhere."""
ROUGHNESS = np.array([0.1, 0.25, 0.5, 1.0])
SAMPLES = (1, 4, 8, 16)
DIRECTIONS = 400
DIELECTRIC_F0 = 0.04


def main() -> None:
    """Measure, and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    assets = os.environ.get("RAYSVC_ASSETS", "../shared/assets")
    parser.add_argument("folder", nargs="?", type=Path, default=Path(assets) / "hdr")
    parser.add_argument("--picture", type=Path)
    arguments = parser.parse_args()
    maps = {name: read(arguments.folder / name) for name in MAPS}
    unseen = {f"builtin:{name}": make().radiance for name, make in BUILTIN_ENVIRONMENTS.items()}

    errors(maps | unseen)
    speeds(maps[MAPS[0]])
    if arguments.picture:
        picture([maps[MAPS[0]], maps[MAPS[1]]]).save(arguments.picture)


def errors(maps: dict[str, Floats]) -> None:
    """Mean relative error of the luminance, over random normals and views with N.V in 0.15..1."""
    rng = np.random.default_rng(2009)
    normal = _unit(rng.normal(size=(DIRECTIONS, 3)))
    tangent = _unit(np.cross(normal, rng.normal(size=(DIRECTIONS, 3))))
    cosine = rng.uniform(0.15, 1.0, (DIRECTIONS, 1))
    view = cosine * normal + np.sqrt(1 - cosine**2) * tangent

    say("| map | lookups | diffuse | " + " | ".join(f"roughness {r}" for r in ROUGHNESS) + " |")
    say("|---" * (3 + len(ROUGHNESS)) + "|")
    table = np.empty((len(maps), len(SAMPLES), 1 + len(ROUGHNESS)))
    for m, (name, radiance) in enumerate(maps.items()):
        light = ImageLight(Environment(radiance))
        truth = outgoing(extract_suns(radiance)[1], normal, view, ROUGHNESS, DIELECTRIC_F0)
        for s, samples in enumerate(SAMPLES):
            lobes = [light.diffuse(white(normal, view, 0.0, 0.5))]
            lobes += [light.specular(white(normal, view, 0.0, r), samples) for r in ROUGHNESS]
            for k, lobe in enumerate(lobes):
                error = np.abs(lobe @ LUMINANCE / (truth[:, k] @ LUMINANCE) - 1)
                table[m, s, k] = 100 * error.mean()
            _row(name.split(".")[0], samples, table[m, s])
    for s, samples in enumerate(SAMPLES):
        _row("**mean of fitted maps**", samples, table[: len(MAPS), s].mean(axis=0))
    for s, samples in enumerate(SAMPLES):
        _row("**mean of unseen maps**", samples, table[len(MAPS) :, s].mean(axis=0))
    say("")


def speeds(radiance: Floats) -> None:
    """Processor time of tables and lookups on one thread, in the order of a sphere's pixels."""
    normal, view, _ = sphere(512)
    light = ImageLight(Environment(radiance))
    say("| what | time |")
    say("|---|---|")
    seconds = _best(lambda: sphere_table(radiance))
    say(f"| tables of a {radiance.shape[1]} x {radiance.shape[0]} map | {1e3 * seconds:.0f} ms |")
    surface = white(normal, view, 0.0, 0.5)
    points = len(normal)
    for what, lobe in (("diffuse", light.diffuse), ("specular", light.specular)):
        seconds = _best(partial(lobe, surface, 4))
        say(f"| {what}, 4 lookups a point | {1e9 * seconds / points:.0f} ns a point |")
    seconds = _best(lambda: light.radiance(normal.astype(np.float32)))
    say(f"| a point of the map | {1e9 * seconds / points:.0f} ns |")
    say("")


def picture(maps: list[Floats], size: int = 128) -> Image.Image:
    """Spheres with 4 lookups a point above their integrals: diffuse, then rougher and rougher."""
    roughness = np.array([0.15, 0.3, 0.5, 0.75, 1.0])
    normal, view, inside = sphere(size)
    rows = []
    for radiance in maps:
        light = ImageLight(Environment(radiance))
        lobes = [light.diffuse(white(normal, view, 0.0, 0.5))]
        lobes += [light.specular(white(normal, view, 1.0, r), 4) for r in roughness]
        coarse = extract_suns(radiance)[1]
        coarse = coarse.reshape(len(coarse) // 4, 4, -1, 4, 3).mean(axis=(1, 3))
        truth = outgoing(coarse, normal, view, roughness, 1.0, len(coarse))
        truth[:, 0] = outgoing(coarse, normal, view, roughness[:0], DIELECTRIC_F0, len(coarse))[
            :, 0
        ]
        exposure = 0.3 / np.median(truth)
        for values in (lobes, list(truth.transpose(1, 0, 2))):
            pixels = np.zeros((size, size, len(values), 3))
            pixels[inside] = np.stack(values, axis=1) * exposure
            rows.append(pixels.transpose(0, 2, 1, 3).reshape(size, -1, 3))
    linear = np.concatenate(rows)
    linear = linear / (1 + 0.6 * linear)
    encoded = np.where(linear < 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return Image.fromarray((np.clip(encoded, 0, 1) * 255 + 0.5).astype(np.uint8))


def sphere(size: int) -> tuple[Doubles, Doubles, np.ndarray]:
    """Normals, views (N, 3) of a sphere seen from afar, a little above, and its mask (H, W)."""
    y, x = 1.05 - (np.mgrid[0:size, 0:size] + 0.5) / size * 2.1
    x = -x
    inside = x * x + y * y < 1
    local = np.stack([x, y, np.sqrt(np.maximum(1 - x * x - y * y, 0))], axis=-1)[inside]
    towards = _unit(np.array([[0.0, 0.2, 1.0]]))
    right = np.array([[1.0, 0.0, 0.0]])
    normal = local @ np.concatenate([right, np.cross(towards, right), towards])
    return normal, np.tile(towards, (len(normal), 1)), inside


def white(normal: Doubles, view: Doubles, metallic: float, roughness: float) -> Surface:
    """White surfaces."""
    count = len(normal)

    def filled(value: float, *shape: int) -> Floats:
        return np.full((count, *shape), value, np.float32)

    normal32 = np.ascontiguousarray(normal, np.float32)
    return Surface(
        position=filled(0, 3),
        geometric_normal=normal32,
        normal=normal32,
        to_viewer=np.ascontiguousarray(view, np.float32),
        base_colour=filled(1, 3),
        alpha=filled(1),
        metallic=filled(metallic),
        roughness=filled(roughness),
        dielectric_f0=filled(DIELECTRIC_F0),
        transmission=filled(0),
        emissive=filled(0, 3),
        occlusion=filled(1),
        unlit=np.zeros(count, bool),
        clearance=filled(0),
        coat=Coat.empty(0),
        glass=Glass.empty(0),
    )


def read(path: Path) -> Floats:
    """Pixels (H, W, 3) of a map."""
    pixels = np.asarray(OpenImageIO.ImageBuf(str(path)).get_pixels(OpenImageIO.FLOAT))
    return np.ascontiguousarray(pixels[..., :3], np.float32)


def say(line: str) -> None:
    """Print a line."""
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


def _row(name: str, samples: int, percents: Doubles) -> None:
    say(f"| {name} | {samples} | " + " | ".join(f"{p:.1f} %" for p in percents) + " |")


def _best(work: Callable[[], object], rounds: int = 5) -> float:
    times = []
    for _ in range(rounds):
        start = time.thread_time()
        work()
        times.append(time.thread_time() - start)
    return min(times)


def _unit(vectors: Doubles) -> Doubles:
    unit: Doubles = vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
    return unit


if __name__ == "__main__":
    main()
