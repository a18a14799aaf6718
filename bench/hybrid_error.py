"""How far hybrid pictures are from path-traced ones of the same scenes.

    python -m bench.hybrid_error [--samples N] [--size WxH] [--cache FOLDER] [--pictures FOLDER]
                                 [--set KEY=VALUE ...] [NAME ...]

Prints a Markdown table. Scenes and maps are those of RAYSVC_ASSETS; --set is for the hybrid
pictures, to measure what a setting is worth.
"""

import argparse
import os
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import raysvc
from bench.reference_cache import reference_picture
from raysvc.cli.arguments import camera_mapping, settings_mapping
from raysvc.compare.picture_comparison import difference_png, reference_settings
from raysvc.compare.picture_difference import picture_difference

ENVIRONMENTS = ("venice_sunset_1k.hdr", "studio_small_03_1k.hdr")


@dataclass(frozen=True)
class Subject:
    """A scene as it is looked at."""

    name: str
    source: str
    """Below the assets, or built in."""
    camera: Mapping[str, Any] = field(default_factory=dict)
    """By default the scene's bounds are framed."""
    settings: Mapping[str, Any] = field(default_factory=dict)


SUBJECTS = (
    Subject("shiny", "builtin:shiny", {"gltf_camera": 0}),
    Subject("FlightHelmet", "gltf/FlightHelmet/FlightHelmet.gltf"),
    Subject("PBR_Spheres", "gltf/PBR_Spheres.glb"),
    Subject(
        "DepthOfFieldExample",
        "gltf/DepthOfFieldExample.glb",
        {"eye": (0.9, 1.6, 3.6), "target": (0.0, 0.5, 0.0), "aperture_radius": 0.1},
        # Its sun has 6,830 lux: the sky is made as strong as belongs to it.
        {"environment_strength": 1000.0, "exposure_stops": -11.0},
    ),
)


def main() -> None:
    """Measure, and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("names", nargs="*", metavar="NAME", help="of subjects; all by default")
    parser.add_argument("--samples", type=int, default=256, help="of the reference, per pixel")
    parser.add_argument("--size", default="640x360")
    parser.add_argument("--cache", type=Path, help="where references are kept")
    parser.add_argument("--pictures", type=Path, help="where pictures and differences go")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    arguments = parser.parse_args()
    unknown = set(arguments.names) - {subject.name for subject in SUBJECTS}
    if unknown:
        parser.error(f"unknown {', '.join(unknown)}")
    say(
        "| scene | light | FLIP | where the scene is | HDR-FLIP | relMSE | trimmed | mean ratio "
        "| seconds | reference |"
    )
    say("|---|---|" + "--:|" * 8)
    for row in rows(arguments):
        say("| " + " | ".join(row) + " |")


def rows(arguments: argparse.Namespace) -> Iterator[tuple[str, ...]]:
    """A row for each subject and map."""
    assets = Path(os.environ.get("RAYSVC_ASSETS", "../shared/assets"))
    given = settings_mapping(arguments.set)
    for subject in SUBJECTS:
        if arguments.names and subject.name not in arguments.names:
            continue
        built_in = subject.source.startswith("builtin:")
        scene = raysvc.load(subject.source if built_in else str(assets / subject.source))
        view = raysvc.View(**{**camera_mapping(None, arguments.size), **subject.camera})
        settings = raysvc.Settings(**{**subject.settings, **given})
        true = reference_settings(raysvc.Settings(**subject.settings), arguments.samples)
        for name in ENVIRONMENTS:
            light = raysvc.load_environment(assets / "hdr" / name)
            reference, taken = reference_picture(arguments.cache, scene, light, view, true)
            raysvc.render(scene, light, view, settings)  # warms up
            frame = raysvc.render(scene, light, view, settings)
            found = picture_difference(
                frame.layers["beauty"], reference, settings.tone_map, settings.exposure_stops
            )
            if arguments.pictures:
                arguments.pictures.mkdir(parents=True, exist_ok=True)
                file = f"{subject.name}_{name.partition('.')[0]}.png"
                (arguments.pictures / file).write_bytes(difference_png(found))
            figures = found.figures
            ratio = "-" if figures.mean_ratio is None else f"{figures.mean_ratio:.3f}"
            yield (
                subject.name,
                name.partition(".")[0],
                f"{figures.flip:.4f}",
                f"{found.flip_map[frame.layers['id'] >= 0].mean():.4f}",
                f"{figures.hdr_flip:.4f}",
                f"{figures.rel_mse:.4f}",
                f"{figures.rel_mse_trimmed:.4f}",
                ratio,
                f"{frame.statistics.total_seconds:.2f}",
                f"{taken:.1f}",
            )


def say(line: str) -> None:
    """Print a line."""
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
