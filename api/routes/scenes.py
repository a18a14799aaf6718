"""Scenes: sent once, immutable, named by their content."""

from fastapi import APIRouter, Request, Response

from api.context import ContextDep
from api.responses import SafeJSONResponse
from api.routes.stored import PROBLEM_RESPONSES, UPLOAD_BODY, add
from api.schemas import SceneList, SceneResource, scene_resource

router = APIRouter(prefix="/v1/scenes", tags=["scenes"], responses=PROBLEM_RESPONSES)


@router.post(
    "",
    status_code=201,
    responses={
        200: {"model": SceneResource, "description": "Known already"},
        201: {"model": SceneResource},
    },
    openapi_extra=UPLOAD_BODY,
)
async def add_scene(request: Request, context: ContextDep) -> Response:
    """Send a scene, or name a built-in one; sending it again finds the one that is there."""
    record, new = await add(request, context, context.service.scenes)
    resource = scene_resource(record)
    return SafeJSONResponse(
        resource.model_dump(mode="json"), 201 if new else 200, {"Location": resource.links["self"]}
    )


@router.get("", responses={200: {"model": SceneList}})
async def list_scenes(context: ContextDep) -> Response:
    """All scenes, newest first."""
    scenes = [scene_resource(record) for record in context.service.scenes.records()]
    return SafeJSONResponse(SceneList(scenes=scenes).model_dump(mode="json"))


@router.get("/{id}", responses={200: {"model": SceneResource}})
async def get_scene(id: str, context: ContextDep) -> Response:
    """What is known about a scene."""
    resource = scene_resource(context.service.scenes.record(id))
    return SafeJSONResponse(resource.model_dump(mode="json"))


@router.delete("/{id}", status_code=204)
async def delete_scene(id: str, context: ContextDep) -> Response:
    """Forget a scene and its files."""
    await context.heavy(lambda: context.service.scenes.delete(id))
    return Response(status_code=204)
