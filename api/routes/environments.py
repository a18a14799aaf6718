"""Environments: sent once, immutable, named by their content."""

from fastapi import APIRouter, Request, Response

from api.context import ContextDep
from api.responses import SafeJSONResponse
from api.routes.stored import PROBLEM_RESPONSES, UPLOAD_BODY, add
from api.schemas import EnvironmentList, EnvironmentResource, environment_resource

router = APIRouter(prefix="/v1/environments", tags=["environments"], responses=PROBLEM_RESPONSES)


@router.post(
    "",
    status_code=201,
    responses={
        200: {"model": EnvironmentResource, "description": "Known already"},
        201: {"model": EnvironmentResource},
    },
    openapi_extra=UPLOAD_BODY,
)
async def add_environment(request: Request, context: ContextDep) -> Response:
    """Send an environment, or name a built-in one; sending it again finds the one that is there."""
    record, new = await add(request, context, context.service.environments)
    resource = environment_resource(record)
    return SafeJSONResponse(
        resource.model_dump(mode="json"), 201 if new else 200, {"Location": resource.links["self"]}
    )


@router.get("", responses={200: {"model": EnvironmentList}})
async def list_environments(context: ContextDep) -> Response:
    """All environments, newest first."""
    environments = [
        environment_resource(record) for record in context.service.environments.records()
    ]
    return SafeJSONResponse(EnvironmentList(environments=environments).model_dump(mode="json"))


@router.get("/{id}", responses={200: {"model": EnvironmentResource}})
async def get_environment(id: str, context: ContextDep) -> Response:
    """What is known about an environment."""
    resource = environment_resource(context.service.environments.record(id))
    return SafeJSONResponse(resource.model_dump(mode="json"))


@router.delete("/{id}", status_code=204)
async def delete_environment(id: str, context: ContextDep) -> Response:
    """Forget an environment and its files."""
    await context.heavy(lambda: context.service.environments.delete(id))
    return Response(status_code=204)
