"""Only the filtered maps of an environment, its irradiance and its spherical harmonics."""

from typing import Any

from fastapi import APIRouter, Request, Response

from api.context import ContextDep
from api.filter_schemas import MEDIA_TYPES, FilteredBody, Sh9Body, check_harmonics_only
from api.json_bodies import read_json_object
from api.negotiation import format_for
from api.render_requests import stored_id
from api.responses import SafeJSONResponse
from api.routes.stored import PROBLEM_RESPONSES
from raysvc.frame.settings import checked
from raysvc.lighting.filtered_set import check_format, filtered_maps
from raysvc.lighting.spherical_harmonics import sh9
from raysvc.parallel import Control
from raysvc.scene import Environment

router = APIRouter(prefix="/v1/environments", tags=["environments"], responses=PROBLEM_RESPONSES)

FILTERED_BODY = {
    "requestBody": {
        "required": True,
        "content": {"application/json": {"schema": {"$ref": "#/components/schemas/FilteredBody"}}},
    }
}
MAPS: dict[str, Any] = {
    media_type: {} for name, media_type in MEDIA_TYPES.items() if name != "json"
}


@router.post(
    "/{id}/filtered",
    responses={200: {"model": Sh9Body, "description": "Maps or harmonics", "content": MAPS}},
    openapi_extra=FILTERED_BODY,
)
async def filter_environment(id: str, request: Request, context: ContextDep) -> Response:
    """Filter an environment for roughnesses; as JSON, say its nine spherical harmonics."""
    settings, store = context.settings, context.service.environments
    body = checked(FilteredBody, await read_json_object(request, settings.max_json_bytes), "")
    format = body.format or format_for(request.headers.get("accept"), MEDIA_TYPES)
    turned = {"yaw_deg": body.environment_yaw_deg, "strength": body.environment_strength}
    headers = {"Vary": "Accept"}

    def environment() -> Environment:
        return store.get(stored_id(id, "environment", store))

    if format == "json":
        check_harmonics_only(body)
        found = await context.long(lambda: sh9(environment(), **turned))
        return SafeJSONResponse(found.to_dict(), headers=headers)

    check_format(format, len(body.roughness) + body.irradiance)

    def encoded() -> bytes:
        maps = filtered_maps(
            environment(),
            body.roughness,
            body.irradiance,
            body.size,
            **turned,
            limits=context.service.limits,
            control=Control(deadline_s=settings.deadline_s),
        )
        return maps.encode(format)

    data = await context.long(encoded)
    return Response(data, media_type=MEDIA_TYPES[format], headers=headers)
