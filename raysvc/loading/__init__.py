"""Scene and environment files in, checked data out."""

from raysvc.loading.environment_file import load_environment
from raysvc.loading.scene_file import load_scene

__all__ = ["load_environment", "load_scene"]
