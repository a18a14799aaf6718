"""`raysvc serve`: the service, on this machine."""

import ipaddress
import os
import socket
from pathlib import Path
from typing import Annotated

import typer
import uvicorn

from raysvc.access import KeyStore
from raysvc.data_folder import VARIABLE, chosen_data_dir
from raysvc.errors import InvalidSetting

APPLICATION = "api.serving:served_app"
"""By name: the core never imports `api`."""
HOSTS = "RAYSVC_HOSTS"
LOOPBACK_NAMES = ("localhost", "127.0.0.1", "[::1]")
"""What this machine calls itself. Another name that leads here was made to (DNS rebinding)."""
ANSWERS_WITHIN_S = 20
"""Time that open requests have to be answered once the service is told to stop."""


def serve(
    host: Annotated[str, typer.Option("--host", help="Address to listen on.")] = "127.0.0.1",
    port: Annotated[
        int, typer.Option("--port", min=0, max=65535, help="Port to listen on; 0 finds a free one.")
    ] = 8000,
    data_dir: Annotated[
        Path | None,
        typer.Option(
            "--data-dir",
            help="Where scenes, environments, jobs, results and keys are kept; by default "
            "RAYSVC_DATA_DIR, else the user's data folder.",
        ),
    ] = None,
    open_: Annotated[
        bool,
        typer.Option("--open", help="Let everybody in where there is no key."),
    ] = False,
) -> None:
    """Run the HTTP service until it is told to stop."""
    # Said once, for whom it concerns: the check below, and the application.
    folder = chosen_data_dir(data_dir)
    os.environ[VARIABLE] = str(folder)
    config = uvicorn.Config(
        APPLICATION,
        factory=True,
        host=host,
        port=port,
        server_header=False,
        timeout_graceful_shutdown=ANSWERS_WITHIN_S,
        log_config=None,
        access_log=False,
    )
    listening = _listen(host, port)
    if not open_ and not is_private(listening) and not _has_keys(folder):
        listening.close()
        raise InvalidSetting(
            f"{host} can be reached from elsewhere, and the service has no key; make one with "
            "`raysvc keys add NAME`, or say --open to let everybody in",
            field="--host",
        )
    address = f"[{host}]" if ":" in host else host
    if is_private(listening) and not os.environ.get(HOSTS):
        os.environ[HOSTS] = ",".join((*LOOPBACK_NAMES, address))
    typer.echo(f"raysvc is at http://{address}:{listening.getsockname()[1]}")
    uvicorn.Server(config).run(sockets=[listening])


def is_private(listening: socket.socket) -> bool:
    """Whether only this machine reaches an address."""
    if listening.family not in (socket.AF_INET, socket.AF_INET6):
        return True
    return ipaddress.ip_address(listening.getsockname()[0].partition("%")[0]).is_loopback


def _has_keys(folder: Path) -> bool:
    keys = KeyStore(folder)
    try:
        return keys.guarded
    finally:
        keys.close()


def _listen(host: str, port: int) -> socket.socket:
    family, kind, protocol, _, address = socket.getaddrinfo(
        host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
    )[0]
    listening = socket.socket(family, kind, protocol)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind(address)
    except OSError as error:
        listening.close()
        raise OSError(error.errno, error.strerror, f"{host}:{port}") from None
    return listening
