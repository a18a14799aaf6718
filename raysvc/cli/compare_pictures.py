"""`raysvc compare --pictures`: a picture beside the one that it should be."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.console import Console

from raysvc.cli.arguments import output_format, settings_mapping, writable
from raysvc.cli.progress import progress_bar
from raysvc.cli.tables import difference_table, show
from raysvc.compare.picture_comparison import (
    compare_pictures,
    difference_png,
    reference_settings,
)
from raysvc.frame.settings import checked, settings_from
from raysvc.frame.view import View
from raysvc.loading import load_environment, load_scene
from raysvc.parallel import Control


def show_difference(
    scene: str,
    environment: str | None,
    probe: Mapping[str, Any] | None,
    camera: Mapping[str, Any],
    assignments: Sequence[str],
    samples: int | None,
    picture: Path,
    output: Path | None,
) -> None:
    """Render both, write what was asked for, and show the figures."""
    output_format(writable(picture, "--pictures"), "--pictures", ("png",))
    if output is not None:
        output_format(writable(output, "--output"), "--output", ("json",))
    settings = settings_from(settings_mapping(assignments))
    reference_settings(settings, samples)
    view = checked(View, camera, "camera")
    with progress_bar(scene) as report:
        report("loading", 0.0)
        light = None if environment is None else load_environment(environment)
        compared = compare_pictures(
            load_scene(scene),
            light if probe is None else {**probe, "environment": light},
            view,
            settings,
            samples,
            source=scene,
            environment_source=environment or "",
            control=Control(on_progress=report),
        )
    picture.write_bytes(difference_png(compared.difference))
    figures = compared.to_dict()
    if output is not None:
        text = json.dumps(figures, indent=2, allow_nan=False) + "\n"
        output.write_text(text, encoding="utf-8")
    console = Console(stderr=True)
    for warning in compared.warnings:
        console.print(f"warning: {warning}", markup=False, highlight=False)
    show(difference_table(figures))
