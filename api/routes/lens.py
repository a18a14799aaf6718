"""A picture and its depth in, the picture through a lens out."""

import json
import math
from typing import Annotated, Any, Final, NamedTuple

from fastapi import APIRouter, Query, Request, Response

from api.context import Context, ContextDep
from api.forms import Form, is_multipart, read_form
from api.json_bodies import parse_object
from api.negotiation import MEDIA_TYPES, format_for
from api.pictures import ImageQuery
from api.problems import UnsupportedMediaType
from api.routes.renders import IMAGE_RESPONSE
from api.routes.stored import PROBLEM_RESPONSES
from api.waiting import for_client
from raysvc.errors import InvalidInput, InvalidSetting
from raysvc.frame.refocus import CAMERA_FIELDS, SETTINGS_FIELDS, Refocused, linear, refocus
from raysvc.loading.picture_file import StoredPicture, holds_depth
from raysvc.parallel import Control
from raysvc.types import Floats

router = APIRouter(prefix="/v1/lens", tags=["lens"], responses=PROBLEM_RESPONSES)

FILES: Final = {"picture", "depth"}
TEXTS: Final = {"camera", "settings", "depth_scale_m"}

FILE: Final = {"type": "string", "contentMediaType": "application/octet-stream"}
LENS_BODY: Final[dict[str, Any]] = {
    "requestBody": {
        "required": True,
        "content": {
            "multipart/form-data": {
                "schema": {
                    "type": "object",
                    "required": ["picture", "camera"],
                    "properties": {
                        "picture": {**FILE, "description": "EXR, NPZ, PNG, JPEG or WebP."},
                        "depth": {
                            **FILE,
                            "description": "EXR, NPZ or PNG; by default what the picture's file "
                            "holds.",
                        },
                        "depth_scale_m": {
                            "type": "number",
                            "description": "Metres of one step of grey, of a PNG.",
                        },
                        "camera": {
                            "type": "object",
                            "description": f"JSON with some of {', '.join(CAMERA_FIELDS)}.",
                        },
                        "settings": {
                            "type": "object",
                            "description": f"JSON with some of {', '.join(SETTINGS_FIELDS)}.",
                        },
                    },
                }
            }
        },
    }
}


@router.post("", response_class=Response, responses={200: IMAGE_RESPONSE}, openapi_extra=LENS_BODY)
async def lens(
    query: Annotated[ImageQuery, Query()], request: Request, context: ContextDep
) -> Response:
    """Give a picture of any renderer depth of field; a client that goes away stops it."""
    if not is_multipart(request):
        raise UnsupportedMediaType("send multipart/form-data", field="Content-Type")
    format = query.format or format_for(request.headers.get("accept"))
    form = await read_form(request, len(FILES), context.settings.max_json_bytes)
    try:
        read = await context.reading(lambda: _read(form, context))
    finally:
        form.close()
    control = Control(deadline_s=context.settings.deadline_s)

    def made() -> tuple[Refocused, bytes]:
        found = refocus(
            linear(read.picture), read.depth, read.camera, read.settings, control=control
        )
        return found, found.encode(format, query.layer)

    found, data = await for_client(made, control, request, context)
    headers = {
        "Vary": "Accept",
        "Server-Timing": f"lens;dur={1000 * found.seconds:.1f}",
        "X-Raysvc-Statistics": json.dumps(
            found.statistics() | {"warnings": len(found.warnings)}, separators=(",", ":")
        ),
    }
    return Response(data, media_type=MEDIA_TYPES[format], headers=headers)


class _Asked(NamedTuple):
    """What a form holds, read."""

    picture: StoredPicture
    depth: Floats
    camera: dict[str, Any]
    settings: dict[str, Any]


def _read(form: Form, context: Context) -> _Asked:
    form.refuse_unknown(FILES, TEXTS)
    camera, settings = (
        parse_object(form.texts[part], part) if part in form.texts else {}
        for part in ("camera", "settings")
    )
    scale = _scale(form.texts.get("depth_scale_m"))
    parser = context.service.parser
    shown = _file(form, "picture")
    if "depth" not in form.files and not holds_depth(shown):
        raise InvalidInput("is missing, and the picture holds none", field="depth")
    deep = _file(form, "depth") if "depth" in form.files else shown
    return _Asked(parser.picture(shown), parser.depth(deep, scale), camera, settings)


def _file(form: Form, field: str) -> bytes:
    files = form.files.get(field, [])
    if len(files) != 1:
        raise InvalidInput("is missing" if not files else "is given twice", field=field)
    return files[0].file.read()


def _scale(text: str | None) -> float | None:
    if text is None:
        return None
    try:
        scale = float(text)
    except ValueError:
        scale = math.nan
    if not 0.0 < scale < 1e9:
        raise InvalidSetting(
            f"must be a number of metres more than 0 (got {text[:40]!r})", field="depth_scale_m"
        )
    return scale
