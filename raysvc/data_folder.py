"""Where a service's data is: what its commands and its application must agree on."""

import os
from pathlib import Path
from typing import Final

VARIABLE: Final = "RAYSVC_DATA_DIR"


def default_data_dir() -> Path:
    """Folder for data that a user's programs keep."""
    home = os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share"
    return Path(home) / "raysvc"


def chosen_data_dir(given: Path | None = None) -> Path:
    """The folder that was given, else RAYSVC_DATA_DIR unless that is empty, else the default.

    Absolute, so that it stays the same when it is said again.
    """
    return (given or Path(os.environ.get(VARIABLE) or default_data_dir())).absolute()
