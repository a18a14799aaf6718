"""The commands, and how their errors end the process."""

import sys
from collections.abc import Sequence
from typing import Annotated, NoReturn

import typer

from raysvc.cli.bench import bench
from raysvc.cli.compare import compare
from raysvc.cli.demo import demo
from raysvc.cli.filter import filter_environment
from raysvc.cli.inspect import inspect
from raysvc.cli.keys import keys
from raysvc.cli.lens import lens
from raysvc.cli.render import render
from raysvc.cli.serve import serve
from raysvc.cli.settings import settings
from raysvc.cli.warmup import warmup
from raysvc.errors import InvalidInput, NotFound, RaysvcError, Unavailable
from raysvc.version import VERSION

EXIT_WRONG_INPUT = 2
EXIT_FAILURE = 1

app = typer.Typer(
    name="raysvc",
    help="A 3D scene and a camera in, a picture out, on a CPU.",
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
for command in (serve, settings, render, lens, compare, inspect, warmup, demo):
    app.command()(command)
app.command("filter")(filter_environment)
app.add_typer(bench)
app.add_typer(keys)


def _show_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"raysvc {VERSION}")
        raise typer.Exit()


@app.callback(invoke_without_command=True)
def _root(
    context: typer.Context,
    version: Annotated[
        bool,
        typer.Option("--version", is_eager=True, callback=_show_version, help="Say which this is."),
    ] = False,
) -> None:
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())
        raise typer.Exit(EXIT_WRONG_INPUT)


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Run a command and leave the process with its exit code."""
    sys.exit(run(arguments))


def run(arguments: Sequence[str] | None = None) -> int:
    """Run a command; returns its exit code."""
    try:
        code = app(arguments, prog_name="raysvc", standalone_mode=False)
    except typer.TyperException as error:
        return _failed(error.format_message(), error.exit_code)
    except typer.Abort:
        return _failed("aborted", EXIT_FAILURE)
    except (InvalidInput, NotFound, Unavailable) as error:
        return _failed(str(error), EXIT_WRONG_INPUT)
    except RaysvcError as error:
        return _failed(str(error), EXIT_FAILURE)
    except OSError as error:
        return _failed(f"{error.filename or 'system'}: {error.strerror or error}", EXIT_FAILURE)
    return code if isinstance(code, int) else 0


def _failed(message: str, code: int) -> int:
    typer.echo(f"error: {' '.join(message.split())}", err=True)
    return code
