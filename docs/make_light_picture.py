"""Draws docs/images/image_light.png: spheres under five maps above their integrals.

    python -m docs.make_light_picture [FOLDER OF .hdr AND .exr]

Diffuse, then metal of growing roughness. Suns are left out on both sides: they are no part of what
is filtered.
"""

import argparse
import os
from pathlib import Path

import numpy as np
from PIL import Image

from raysvc.builtin import BUILTIN_ENVIRONMENTS
from raysvc.compare.lobe_integrals import diffuse_integrals, specular_integrals
from raysvc.compare.white_surface import DIELECTRIC_F0, sphere, white_surface
from raysvc.lighting.area_resampling import resampled
from raysvc.lighting.image_light import Filtering, ImageLight
from raysvc.loading import load_environment
from raysvc.parallel import Control, map_chunks
from raysvc.scene import Environment
from raysvc.types import Bools, Doubles, Floats

MAPS = (
    "venice_sunset_1k.hdr",
    "studio_small_03_1k.hdr",
    "kloppenheim_05_1k.hdr",
    "KernerEnvLatLong.exr",
)
ROUGHNESS = (0.05, 0.1, 0.25, 0.5, 0.75, 1.0)
PICTURE = Path(__file__).parent / "images" / "image_light.png"
SIZE = 80
NARROW = 0.1
"""Up to this roughness integrals are sums over a thousand points of the lobe, above over all texels
of a map of COARSE_ROWS."""
COARSE_ROWS = 128


def main() -> None:
    """Draw and write the picture."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    assets = os.environ.get("RAYSVC_ASSETS", "../shared/assets")
    parser.add_argument("folder", nargs="?", type=Path, default=Path(assets) / "hdr")
    folder = parser.parse_args().folder
    environments = [load_environment(folder / name) for name in MAPS]
    environments.append(BUILTIN_ENVIRONMENTS["studio"]())
    rows = [row for environment in environments for row in spheres(environment)]
    linear = np.concatenate(rows)
    linear = linear / (1 + 0.6 * linear)
    encoded = np.where(linear < 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    Image.fromarray((np.clip(encoded, 0, 1) * 255 + 0.5).astype(np.uint8)).save(PICTURE)


def spheres(environment: Environment) -> list[Doubles]:
    """Two rows of spheres (SIZE, SIZE * lobes, 3): as rendered, and their integrals."""
    normal, view, inside = sphere(SIZE)
    light = ImageLight(environment)
    lit = [light.diffuse(white_surface(normal, view, 0.0, 0.5))]
    lit += [light.specular(white_surface(normal, view, 1.0, r)) for r in ROUGHNESS]

    brute = ImageLight(environment, filtering=Filtering("brute"))
    coarse = resampled(light.rest, COARSE_ROWS, 2 * COARSE_ROWS).astype(np.float32)

    def integrals(begin: int, end: int) -> Doubles:
        some = normal[begin:end], view[begin:end]
        lobes = [diffuse_integrals(coarse, *some, DIELECTRIC_F0)]
        for roughness in ROUGHNESS:
            if roughness <= NARROW:
                surface = white_surface(*some, 1.0, roughness)
                lobes.append(brute.specular(surface).astype(np.float64))
            else:
                lobes.append(specular_integrals(coarse, *some, roughness, 1.0))
        return np.stack(lobes, axis=1)

    truth = np.concatenate(map_chunks(len(normal), 50, integrals, Control()))
    exposure = 0.3 / float(np.median(truth))
    shown = np.stack(lit, axis=1)
    return [_row(lobes * exposure, inside) for lobes in (shown, truth)]


def _row(lobes: Floats | Doubles, inside: Bools) -> Doubles:
    pixels = np.zeros((SIZE, SIZE, lobes.shape[1], 3))
    pixels[inside] = lobes
    row: Doubles = pixels.transpose(0, 2, 1, 3).reshape(SIZE, -1, 3)
    return row


if __name__ == "__main__":
    main()
