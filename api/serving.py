"""The application as `raysvc serve` runs it: with the process's log set up as well."""

from fastapi import FastAPI

from api.app import create_app
from api.logs import configure_logging
from api.settings import settings_from_environment


def served_app() -> FastAPI:
    """Build the application from RAYSVC_... variables. Raises InvalidSetting."""
    settings = settings_from_environment()
    configure_logging(settings.log_format, settings.log_level)
    return create_app(settings)
