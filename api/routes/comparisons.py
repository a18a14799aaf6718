"""Comparisons of acceleration structures: asked for, watched, cancelled, read."""

from collections.abc import Callable
from typing import Any, Final, Literal

import anyio.to_thread
from fastapi import APIRouter, Request, Response
from starlette.responses import StreamingResponse

from api.comparison_requests import submit
from api.comparison_schemas import ComparisonResource, comparison_resource, result_links
from api.context import Context, ContextDep
from api.events import EVENTS_PARAMETERS, EVENTS_RESPONSES, events_response
from api.idempotency import KEY_PARAMETER, key_of
from api.json_bodies import read_json_object
from api.negotiation import matches
from api.responses import SafeJSONResponse
from api.routes.stored import PROBLEM_RESPONSES
from api.waiting import answer_to_new
from raysvc.compare.result import Comparison
from raysvc.compare.tables import table
from raysvc.errors import NotFound
from raysvc.jobs import ComparisonRequest

router = APIRouter(prefix="/v1/comparisons", tags=["comparisons"], responses=PROBLEM_RESPONSES)

COMPARISON_BODY = {
    "requestBody": {
        "required": True,
        "content": {
            "application/json": {"schema": {"$ref": "#/components/schemas/ComparisonBody"}}
        },
    }
}
MEDIA_TYPES: Final = {
    "json": "application/json",
    "csv": "text/csv; charset=utf-8",
    "md": "text/markdown; charset=utf-8",
    "svg": "image/svg+xml",
    "png": "image/png",
    "exr": "image/x-exr",
}


def _answers(*formats: str) -> dict[int | str, dict[str, Any]]:
    """How a route's file looks in the schema."""
    content: dict[str, Any] = {MEDIA_TYPES[format].partition(";")[0]: {} for format in formats}
    return {200: {"description": "The file", "content": content}}


@router.post(
    "",
    status_code=202,
    responses={
        200: {"model": ComparisonResource, "description": "Finished within `Prefer: wait=N`"},
        202: {"model": ComparisonResource},
    },
    openapi_extra=COMPARISON_BODY | {"parameters": [KEY_PARAMETER]},
)
async def add_comparison(request: Request, context: ContextDep) -> Response:
    """Ask for a measurement; with `Prefer: wait=N` the answer waits up to N seconds for it."""
    body = await read_json_object(request, context.settings.max_json_bytes)
    key = key_of(request, body)
    job = await context.heavy(lambda: submit(context.service, body, key))
    status, headers = await answer_to_new(job, f"/v1/comparisons/{job.id}", request, context)
    resource = comparison_resource(job, context.service.position(job))
    return SafeJSONResponse(resource.model_dump(mode="json"), status, headers)


@router.get("/{id}", responses={200: {"model": ComparisonResource}})
async def get_comparison(id: str, context: ContextDep) -> Response:
    """How far a comparison is, and what was measured."""
    job, position = await context.looked_up(id, ComparisonRequest)
    resource = comparison_resource(job, position)
    return SafeJSONResponse(resource.model_dump(mode="json"), headers={"Cache-Control": "no-store"})


@router.get(
    "/{id}/table.{format}", response_class=Response, responses=_answers("json", "csv", "md")
)
async def get_table(
    id: str, format: Literal["json", "csv", "md"], request: Request, context: ContextDep
) -> Response:
    """The figures as a file."""
    return await _file(
        id, f"table.{format}", request, context, lambda measured: table(measured, format).encode()
    )


@router.get("/{id}/chart.{format}", response_class=Response, responses=_answers("svg", "png"))
async def get_chart(
    id: str, format: Literal["svg", "png"], request: Request, context: ContextDep
) -> Response:
    """The figures as bars, and as curves where scaling was measured."""

    def drawn(measured: Comparison) -> bytes:
        # Matplotlib is slow to import, and few requests need it.
        from raysvc.compare.charts import chart

        return chart(measured, format)

    return await _file(id, f"chart.{format}", request, context, drawn)


@router.get("/{id}/heat_map.{format}", response_class=Response, responses=_answers("png", "exr"))
async def get_heat_map(
    id: str, format: Literal["png", "exr"], request: Request, context: ContextDep
) -> Response:
    """Node steps and triangle tests by pixel, where `heat_map` was asked for."""

    def drawn(measured: Comparison) -> bytes:
        from raysvc.compare.heat_map_files import heat_maps_exr, heat_maps_png

        if not measured.heat_maps:
            raise NotFound(
                "was not asked for, or no structure that was asked shows its steps", "heat_map"
            )
        return {"png": heat_maps_png, "exr": heat_maps_exr}[format](measured.heat_maps)

    return await _file(id, f"heat_map.{format}", request, context, drawn)


@router.get(
    "/{id}/events",
    response_class=StreamingResponse,
    responses=EVENTS_RESPONSES,
    openapi_extra=EVENTS_PARAMETERS,
)
async def watch_comparison(id: str, request: Request, context: ContextDep) -> Response:
    """How far a comparison is, told as it changes: Server-Sent Events."""
    job, _ = await context.looked_up(id, ComparisonRequest)
    return events_response(job, result_links(job.request), request, context)


@router.delete("/{id}", status_code=202, responses={202: {"model": ComparisonResource}})
async def cancel_comparison(id: str, context: ContextDep) -> Response:
    """Cancel a comparison that waits or runs; one that has ended stays as it is."""
    job, _ = await context.looked_up(id, ComparisonRequest)
    await anyio.to_thread.run_sync(job.cancel)
    resource = comparison_resource(job, context.service.position(job))
    return SafeJSONResponse(resource.model_dump(mode="json"), 202)


async def _file(
    id: str,
    name: str,
    request: Request,
    context: Context,
    make: Callable[[Comparison], bytes],
) -> Response:
    """Answer with a file made of a finished comparison, or with 304 where the client holds it."""
    job, _ = await context.looked_up(id, ComparisonRequest)
    etag = f'"{job.request.name[:32]}-{name}"'
    headers = {"ETag": etag, "Cache-Control": "private, max-age=86400"}
    if job.statistics is not None and matches(request.headers.get("if-none-match"), etag):
        return Response(status_code=304, headers=headers)
    data = await context.heavy(lambda: make(context.service.comparison(job)))
    media_type = MEDIA_TYPES[name.rpartition(".")[2]]
    return Response(data, media_type=media_type, headers=headers)
