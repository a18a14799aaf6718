"""Where a scene's vertices are, and the same scene with its vertices elsewhere."""

from typing import Any, Final

from fastapi import APIRouter, Request, Response

from api.binary_bodies import read_binary
from api.context import Context, ContextDep
from api.negotiation import MEDIA_TYPES, matches
from api.responses import SafeJSONResponse
from api.routes.stored import PROBLEM_RESPONSES
from api.schemas import SceneResource, scene_resource
from raysvc.jobs import Record
from raysvc.loading.shape_file import largest_shape_file, npy_of

router = APIRouter(prefix="/v1/scenes/{id}/positions", tags=["scenes"], responses=PROBLEM_RESPONSES)

NPY: Final = "application/x-npy"
MEDIA: Final = ("application/octet-stream", NPY, MEDIA_TYPES["npz"], "application/zip")
"""What positions are sent as; which of the forms it is, the bytes themselves say."""

POSITIONS_BODY: Final[dict[str, Any]] = {
    "requestBody": {
        "required": True,
        "description": "(V, 3) numbers as .npy, or .npz with `positions` and perhaps `normals`, "
        "or little-endian float32 alone; V and the order are those of GET.",
        "content": {media: {"schema": {"type": "string", "format": "binary"}} for media in MEDIA},
    }
}


@router.get(
    "",
    response_class=Response,
    responses={200: {"content": {NPY: {}}, "description": "(V, 3) float32"}},
)
async def get_positions(id: str, request: Request, context: ContextDep) -> Response:
    """Where the vertices are, as .npy: (V, 3) float32, metres, in the order in which raysvc has
    them."""
    store = context.service.scenes
    store.record(id)
    headers = {"ETag": f'"{id}-positions"', "Cache-Control": "private, max-age=86400"}
    if matches(request.headers.get("if-none-match"), headers["ETag"]):
        return Response(status_code=304, headers=headers)
    data = await context.heavy(lambda: npy_of(store.get(id).positions))
    return Response(data, media_type=NPY, headers=headers)


@router.put(
    "",
    status_code=201,
    responses={
        200: {"model": SceneResource, "description": "Known already"},
        201: {"model": SceneResource},
    },
    openapi_extra=POSITIONS_BODY,
)
async def put_positions(id: str, request: Request, context: ContextDep) -> Response:
    """Make the scene that is this one with its vertices elsewhere; this one stays as it is."""
    vertices = context.service.scenes.record(id).summary["vertices"]
    body = await read_binary(request, largest_shape_file(vertices), MEDIA)
    record, new = await context.reading(lambda: _add(context, id, body, vertices))
    resource = scene_resource(record)
    return SafeJSONResponse(
        resource.model_dump(mode="json"), 201 if new else 200, {"Location": resource.links["self"]}
    )


def _add(context: Context, id: str, body: bytearray, vertices: int) -> tuple[Record, bool]:
    return context.service.scenes.add_shape(id, context.service.parser.shape(body, vertices))
