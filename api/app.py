"""The application: what is wired to what."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

import anyio
from fastapi import Depends, FastAPI
from fastapi.openapi.utils import get_openapi
from starlette.middleware.cors import CORSMiddleware
from starlette.staticfiles import StaticFiles

from api import access, openapi_schema, problems
from api.body_limit import BodyLimit
from api.context import Context
from api.draining import drained_by_signals
from api.logs import JobLog
from api.metrics import Metrics
from api.origins import OriginCheck
from api.request_ids import HEADER, RequestIds
from api.request_log import RequestLog
from api.routes import (
    comparisons,
    environments,
    filtered,
    health,
    lens,
    metrics,
    one_shot,
    pages,
    positions,
    renders,
    scenes,
    structures,
)
from api.security_headers import SecurityHeaders
from api.settings import ApiSettings, settings_from_environment
from raysvc.access import KeyStore
from raysvc.jobs import MakeRenderer, Observers, RenderService, SceneRenderer
from raysvc.version import VERSION

FORM_OVERHEAD_BYTES = 1 << 20
"""What boundaries, headers and fields of a form may add to its files."""

READABLE_ELSEWHERE = (
    "Location",
    "ETag",
    "Link",
    "Retry-After",
    "Server-Timing",
    "X-Raysvc-Statistics",
    HEADER,
)
"""Headers that pages of the allowed other origins may read."""


def create_app(
    settings: ApiSettings | None = None, make_renderer: MakeRenderer = SceneRenderer
) -> FastAPI:
    """Build the application; settings come from the environment by default (or InvalidSetting).

    The service starts and stops with the application's lifespan.
    """
    settings = settings or settings_from_environment()
    measured, keys = Metrics(), KeyStore(settings.data_dir)
    check_origin = OriginCheck(settings.cors_origins, settings.hosts)
    observer = Observers(measured, JobLog())
    service = RenderService(settings.service_options(), make_renderer, observer)
    measured.read_from(service)

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        service.start()
        with drained_by_signals(service.drain):
            yield
        await anyio.to_thread.run_sync(service.close, settings.grace_s)
        keys.close()

    app = FastAPI(
        title="raysvc",
        summary="A 3D scene and a camera in, a picture out, on a CPU",
        version=VERSION,
        lifespan=lifespan,
        docs_url=None,
        redoc_url=None,
        redirect_slashes=False,
        dependencies=[Depends(access.Guard(keys, check_origin))],
    )
    app.state.context = Context(
        settings,
        service,
        anyio.CapacityLimiter(settings.heavy_threads),
        measured,
        long_workers=anyio.CapacityLimiter(settings.long_threads),
        readers=anyio.CapacityLimiter(max(settings.parse_processes, 1)),
    )
    # The last one that is added is the outermost.
    app.add_middleware(BodyLimit, max_bytes=settings.max_upload_bytes + FORM_OVERHEAD_BYTES)
    if settings.cors_origins:
        app.add_middleware(
            CORSMiddleware,
            allow_origins=settings.cors_origins,
            allow_methods=["*"],
            allow_headers=["*"],
            expose_headers=READABLE_ELSEWHERE,
        )
    app.add_middleware(SecurityHeaders)
    app.add_middleware(RequestLog, metrics=measured)
    app.add_middleware(RequestIds)
    problems.install(app)
    for routes in (
        scenes,
        positions,
        environments,
        filtered,
        renders,
        one_shot,
        lens,
        comparisons,
        structures,
        health,
        metrics,
        pages,
    ):
        app.include_router(routes.router)
    app.mount("/docs/assets", StaticFiles(directory=pages.ASSETS), name="docs-assets")
    app.openapi = lambda: _openapi(app)  # type: ignore[method-assign]
    return app


def _openapi(app: FastAPI) -> dict[str, Any]:
    """The schema, with what the routes' signatures do not say."""
    if app.openapi_schema is None:
        schema = get_openapi(
            title=app.title, version=app.version, summary=app.summary, routes=app.routes
        )
        openapi_schema.complete(schema)
        app.openapi_schema = schema
    return app.openapi_schema
