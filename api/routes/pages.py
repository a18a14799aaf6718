"""The way in: links at `/`, and documentation at `/docs`, which needs nothing from elsewhere."""

from pathlib import Path

import fastapi_offline
from fastapi import APIRouter, Request, Response
from fastapi.openapi.docs import get_swagger_ui_html

from api.responses import SafeJSONResponse
from api.security_headers import POLICY, policy_of_page
from raysvc.version import VERSION

ASSETS = Path(fastapi_offline.__file__).parent / "static"
"""Swagger UI, as a package brings it along."""

router = APIRouter(include_in_schema=False)


@router.get("/")
async def root() -> Response:
    """Where to go from here."""
    links = {
        "documentation": "/docs",
        "openapi": "/openapi.json",
        "scenes": "/v1/scenes",
        "environments": "/v1/environments",
        "renders": "/v1/renders",
        "render": "/v1/render",
        "comparisons": "/v1/comparisons",
        "structures": "/v1/structures",
        "live": "/healthz",
        "ready": "/readyz",
        "metrics": "/metrics",
    }
    return SafeJSONResponse({"service": "raysvc", "version": VERSION, "links": links})


@router.get("/docs")
async def docs(request: Request) -> Response:
    """Every route, to read and to try."""
    root_path = request.scope.get("root_path", "")
    page = get_swagger_ui_html(
        openapi_url=f"{root_path}/openapi.json",
        title="raysvc",
        swagger_js_url=f"{root_path}/docs/assets/swagger-ui-bundle.js",
        swagger_css_url=f"{root_path}/docs/assets/swagger-ui.css",
        swagger_favicon_url=f"{root_path}/docs/assets/favicon.png",
    )
    page.headers[POLICY] = policy_of_page(bytes(page.body))
    return page
