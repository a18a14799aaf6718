"""`raysvc warmup`: compile the kernels before they are needed."""

from raysvc.cli.progress import progress_bar
from raysvc.frame.warm_up import warm_up
from raysvc.parallel import Control


def warmup() -> None:
    """Compile every kernel that a render needs into the cache (RAYSVC_CACHE)."""
    with progress_bar("warmup") as report:
        warm_up(Control(on_progress=report))
