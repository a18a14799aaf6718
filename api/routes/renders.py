"""Renders: asked for, watched, cancelled, looked at."""

from typing import Annotated

import anyio.to_thread
from fastapi import APIRouter, Query, Request, Response
from starlette.responses import StreamingResponse

from api.context import ContextDep
from api.events import EVENTS_PARAMETERS, EVENTS_RESPONSES, events_response
from api.idempotency import KEY_PARAMETER, key_of
from api.json_bodies import read_json_object
from api.negotiation import MEDIA_TYPES
from api.pictures import ImageQuery, image_response, server_timing
from api.render_requests import submit
from api.responses import SafeJSONResponse
from api.routes.stored import PROBLEM_RESPONSES
from api.schemas import RenderResource, render_resource
from api.waiting import answer_to_new
from raysvc.jobs import RenderRequest

router = APIRouter(prefix="/v1/renders", tags=["renders"], responses=PROBLEM_RESPONSES)

RENDER_BODY = {
    "requestBody": {
        "required": True,
        "content": {"application/json": {"schema": {"$ref": "#/components/schemas/RenderBody"}}},
    }
}
IMAGE_RESPONSE = {
    "description": "The picture",
    "content": {media_type: {} for media_type in MEDIA_TYPES.values()},
}


@router.post(
    "",
    status_code=202,
    responses={
        200: {"model": RenderResource, "description": "Finished within `Prefer: wait=N`"},
        202: {"model": RenderResource},
    },
    openapi_extra=RENDER_BODY | {"parameters": [KEY_PARAMETER]},
)
async def add_render(request: Request, context: ContextDep) -> Response:
    """Ask for a picture; with `Prefer: wait=N` the answer waits up to N seconds for it."""
    body = await read_json_object(request, context.settings.max_json_bytes)
    key = key_of(request, body)
    job = await context.heavy(lambda: submit(context.service, body, key))
    status, headers = await answer_to_new(job, f"/v1/renders/{job.id}", request, context)
    resource = render_resource(job, context.service.position(job))
    headers |= server_timing(job)
    return SafeJSONResponse(resource.model_dump(mode="json"), status, headers)


@router.get("/{id}", responses={200: {"model": RenderResource}})
async def get_render(id: str, context: ContextDep) -> Response:
    """How far a render is, and what it took."""
    job, position = await context.looked_up(id, RenderRequest)
    resource = render_resource(job, position)
    headers = {"Cache-Control": "no-store", **server_timing(job)}
    return SafeJSONResponse(resource.model_dump(mode="json"), headers=headers)


@router.get("/{id}/image", response_class=Response, responses={200: IMAGE_RESPONSE})
async def get_image(
    id: str, query: Annotated[ImageQuery, Query()], request: Request, context: ContextDep
) -> Response:
    """A finished render's picture, or one of its layers."""
    job, _ = await context.looked_up(id, RenderRequest)
    return await image_response(job, query, request, context)


@router.get(
    "/{id}/events",
    response_class=StreamingResponse,
    responses=EVENTS_RESPONSES,
    openapi_extra=EVENTS_PARAMETERS,
)
async def watch_render(id: str, request: Request, context: ContextDep) -> Response:
    """How far a render is, told as it changes: Server-Sent Events."""
    job, _ = await context.looked_up(id, RenderRequest)
    return events_response(job, {"image": "image"}, request, context)


@router.delete("/{id}", status_code=202, responses={202: {"model": RenderResource}})
async def cancel_render(id: str, context: ContextDep) -> Response:
    """Cancel a render that waits or runs; one that has ended stays as it is."""
    job, _ = await context.looked_up(id, RenderRequest)
    await anyio.to_thread.run_sync(job.cancel)
    resource = render_resource(job, context.service.position(job))
    return SafeJSONResponse(resource.model_dump(mode="json"), 202)
