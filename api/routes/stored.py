"""What the routes of scenes and of environments share: taking an upload or a built-in name in."""

from typing import Any

from fastapi import Request

from api.context import Context
from api.forms import is_multipart, read_form
from api.json_bodies import read_json_object
from api.problems import MEDIA_TYPE
from api.schemas import BuiltinBody
from raysvc.frame.settings import checked
from raysvc.jobs import ContentStore, Record

UPLOAD_BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            "multipart/form-data": {
                "schema": {
                    "type": "object",
                    "required": ["file"],
                    "properties": {
                        "file": {
                            "type": "array",
                            "items": {
                                "type": "string",
                                "contentMediaType": "application/octet-stream",
                            },
                            "description": "One file, several with relative names, or a .zip.",
                        },
                        "main": {
                            "type": "string",
                            "description": "Which of several files is the main one.",
                        },
                    },
                }
            },
            "application/json": {"schema": BuiltinBody.model_json_schema()},
        },
    }
}

PROBLEM_RESPONSE: dict[str, Any] = {
    "description": "An RFC 9457 problem",
    "content": {MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/ProblemBody"}}},
}
PROBLEM_RESPONSES: dict[int | str, dict[str, Any]] = {
    "4XX": PROBLEM_RESPONSE,
    "5XX": PROBLEM_RESPONSE,
}


async def add(request: Request, context: Context, store: ContentStore[Any]) -> tuple[Record, bool]:
    """Take a body in; returns the record and whether it is new."""
    settings = context.settings
    if not is_multipart(request):
        body = checked(
            BuiltinBody, await read_json_object(request, settings.max_json_bytes), "body"
        )
        return await context.heavy(lambda: store.add_builtin(body.builtin))
    form = await read_form(request, settings.max_upload_files, settings.max_json_bytes)
    try:
        form.refuse_unknown(files={"file"}, texts={"main"})
        return await context.reading(lambda: store.add(form.upload("file", form.texts.get("main"))))
    finally:
        form.close()
