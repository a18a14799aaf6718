"""`raysvc keys`: who may use a service; a running one notices at once."""

from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated

import typer

from raysvc.access import KeyStore, Scope
from raysvc.cli.tables import plain_table, show
from raysvc.data_folder import chosen_data_dir

keys = typer.Typer(
    name="keys", help="Make, list and revoke a service's keys.", no_args_is_help=True
)

DataDir = Annotated[
    Path | None,
    typer.Option("--data-dir", help="The service's folder; by default RAYSVC_DATA_DIR."),
]


@keys.command("add")
def add(
    name: Annotated[str, typer.Argument(help="What people call it.")],
    scope: Annotated[
        Scope, typer.Option("--scope", help="read < render < admin; each holds those before it.")
    ] = Scope.RENDER,
    data_dir: DataDir = None,
) -> None:
    """Make a key and print it, this once. From the first one on, requests need one."""
    with _store(data_dir) as store:
        key = store.add(name, scope)
    typer.echo("keep it well: only its hash is kept here", err=True)
    typer.echo(key)


@keys.command("list")
def list_(data_dir: DataDir = None) -> None:
    """Show the keys, without their secrets."""
    with _store(data_dir) as store:
        rows = [
            (key.id, key.name, key.scope, _day(key.created_s), _day(key.revoked_s))
            for key in store.keys()
        ]
    show(plain_table(("id", "name", "scope", "made", "revoked"), rows))


@keys.command("revoke")
def revoke(
    id: Annotated[str, typer.Argument(help="As `raysvc keys list` shows it.")],
    data_dir: DataDir = None,
) -> None:
    """Let a key in no more. A service whose last key is revoked lets nobody in."""
    with _store(data_dir) as store:
        key = store.revoke(id)
    typer.echo(f"{key.id} ({key.name}) is revoked")


@contextmanager
def _store(data_dir: Path | None) -> Iterator[KeyStore]:
    store = KeyStore(chosen_data_dir(data_dir))
    try:
        yield store
    finally:
        store.close()


def _day(seconds: float | None) -> str:
    if seconds is None:
        return ""
    return datetime.fromtimestamp(seconds, UTC).isoformat(sep=" ", timespec="seconds")
