"""`raysvc settings`: what the service would be told by the environment as it is."""

import importlib
import json
from typing import Annotated

import typer

from raysvc.cli.tables import plain_table, show

DESCRIBED = "api.described_settings"
"""By name: the core never imports `api`."""


def settings(
    as_json: Annotated[bool, typer.Option("--json", help="As JSON, for machines.")] = False,
) -> None:
    """Show every setting of the service: its value, its default, and where it is from."""
    described = importlib.import_module(DESCRIBED)
    found = described.described_settings()
    if as_json:
        typer.echo(json.dumps([setting._asdict() for setting in found], indent=2))
        return
    rows = [
        (
            setting.name,
            described.shown(setting.name, setting.value),
            described.shown(setting.name, setting.default),
            setting.source,
            setting.meaning,
        )
        for setting in found
    ]
    show(plain_table(("variable", "value", "default", "from", "what it means"), rows, (1, 2)))
