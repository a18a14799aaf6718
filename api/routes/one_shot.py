"""A scene in, a picture out, in one request."""

from typing import Annotated, Any

import anyio.to_thread
from fastapi import APIRouter, Query, Request, Response

from api.context import Context, ContextDep
from api.forms import Form, is_multipart, read_form
from api.json_bodies import parse_object, read_json_object
from api.pictures import ImageQuery, image_response, statistics_headers
from api.render_requests import submit
from api.routes.renders import IMAGE_RESPONSE
from api.routes.stored import PROBLEM_RESPONSE, PROBLEM_RESPONSES
from api.waiting import wait_for
from raysvc.errors import Busy, Cancelled, DeadlineExceeded, Draining, InvalidInput
from raysvc.jobs import ContentStore, JobState

router = APIRouter(prefix="/v1/render", tags=["renders"], responses=PROBLEM_RESPONSES)

FILES = {"scene", "environment"}
TEXTS = {"scene", "environment", "probe", "main", "camera", "settings"}

ONE_SHOT_BODY = {
    "requestBody": {
        "required": True,
        "content": {
            "multipart/form-data": {
                "schema": {
                    "type": "object",
                    "required": ["scene"],
                    "properties": {
                        "scene": {
                            "type": "array",
                            "items": {
                                "type": "string",
                                "contentMediaType": "application/octet-stream",
                            },
                            "description": "Files; or as text its id or `builtin:NAME`.",
                        },
                        "environment": {
                            "type": "string",
                            "contentMediaType": "application/octet-stream",
                            "description": "An environment's file; or its id or `builtin:NAME`.",
                        },
                        "probe": {"$ref": "#/components/schemas/ProbeBody"},
                        "main": {"type": "string"},
                        "camera": {"$ref": "#/components/schemas/View"},
                        "settings": {"$ref": "#/components/schemas/Settings"},
                    },
                }
            },
            "application/json": {"schema": {"$ref": "#/components/schemas/RenderBody"}},
        },
    }
}


@router.post(
    "",
    response_class=Response,
    responses={
        200: IMAGE_RESPONSE,
        503: PROBLEM_RESPONSE | {"description": "The service is shutting down"},
    },
    openapi_extra=ONE_SHOT_BODY,
)
async def render(
    query: Annotated[ImageQuery, Query()], request: Request, context: ContextDep
) -> Response:
    """Send everything, wait, receive the picture; a client that goes away cancels it."""
    settings = context.settings
    if is_multipart(request):
        form = await read_form(request, settings.max_upload_files, settings.max_json_bytes)
        try:
            body = await context.reading(lambda: _body_of(form, context))
        finally:
            form.close()
    else:
        body = await read_json_object(request, settings.max_json_bytes)
    job = await context.heavy(lambda: submit(context.service, body))
    request.state.job_id = job.id  # for the log
    if not await wait_for(job, settings.deadline_s, request, context):
        if context.service.draining:
            raise Draining("the service is shutting down; the render goes on in the next process")
        waited = job.state is JobState.QUEUED
        await anyio.to_thread.run_sync(job.cancel)
        if waited:
            raise Busy(
                f"the render waited for {settings.deadline_s:g} seconds, and its turn did not come",
                context.service.retry_after_s,
            )
        raise DeadlineExceeded(f"no picture within {settings.deadline_s:g} seconds", "deadline_s")
    if job.statistics is None and job.error is None:
        raise Cancelled("the render was cancelled")
    response = await image_response(job, query, request, context)
    response.headers.update(statistics_headers(job))
    return response


def _body_of(form: Form, context: Context) -> dict[str, Any]:
    """Store a form's files, and return the body that asks for the same by name."""
    form.refuse_unknown(FILES, TEXTS)
    body: dict[str, Any] = {"scene": _name_of(form, "scene", context.service.scenes)}
    if "environment" in form.files or "environment" in form.texts:
        body["environment"] = _name_of(form, "environment", context.service.environments)
    if "probe" in form.texts:
        probe = parse_object(form.texts["probe"], "probe")
        if "environment" in body:
            if probe.get("environment") is not None:
                raise InvalidInput("is given both in the probe and beside it", "environment")
            probe["environment"] = body["environment"]
        body["environment"] = probe
    for part in ("camera", "settings"):
        if part in form.texts:
            body[part] = parse_object(form.texts[part], part)
    return body


def _name_of(form: Form, field: str, store: ContentStore[Any]) -> str:
    if field in form.files and field in form.texts:
        raise InvalidInput("is given both as a file and as a name", field)
    if field in form.texts:
        return form.texts[field]
    if field not in form.files:
        raise InvalidInput("is missing", field)
    main = form.texts.get("main") if field == "scene" else None
    return store.add(form.upload(field, main))[0].id
