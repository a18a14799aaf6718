"""Presenting the picture of a job."""

import json
from typing import Any, Final, Literal

from fastapi import Request, Response
from pydantic import BaseModel, ConfigDict, Field

from api.context import Context
from api.negotiation import MEDIA_TYPES, format_for, matches
from raysvc.errors import InvalidSetting
from raysvc.jobs import Job, RenderRequest

LONGEST_HEADER: Final = 4_000


class ImageQuery(BaseModel):
    """Which form of a picture."""

    model_config = ConfigDict(extra="forbid")

    layer: str | None = Field(
        None,
        max_length=64,
        description="Such as `beauty`, `depth`, `normal`, `albedo`, `id`; by default `beauty`, "
        "and all of them in `exr` and `npz`.",
    )
    format: Literal["png", "png16", "jpg", "webp", "exr", "npz"] | None = Field(
        None, description="By default what `Accept` asks for, else `png`."
    )


async def image_response(
    job: Job[RenderRequest], query: ImageQuery, request: Request, context: Context
) -> Response:
    """Answer with a job's picture, or with 304 where the client holds it already.

    Raises NotFinished, Gone, NotAcceptable, InvalidSetting, or what made the job fail.
    """
    format = query.format or format_for(request.headers.get("accept"))
    etag = f'"{job.request.name[:32]}-{format}-{query.layer or "all"}"'
    headers = {"ETag": etag, "Vary": "Accept", "Cache-Control": "private, max-age=86400"}
    if job.statistics is not None and matches(request.headers.get("if-none-match"), etag):
        return Response(status_code=304, headers=headers)
    data = await context.heavy(lambda: _encoded(job, format, query.layer, context))
    return Response(data, media_type=MEDIA_TYPES[format], headers=headers | server_timing(job))


def server_timing(job: Job[RenderRequest]) -> dict[str, str]:
    """What a finished render took by stages, as browsers and proxies show it; else nothing."""
    if job.statistics is None:
        return {}
    seconds = {stage["name"]: stage["seconds"] for stage in job.statistics.get("stages", [])}
    seconds["total"] = job.statistics.get("total_seconds", sum(seconds.values()))
    timings = [f"{name.replace(' ', '_')};dur={1000 * s:.1f}" for name, s in seconds.items()]
    return {"Server-Timing": ", ".join(timings)[:LONGEST_HEADER]}


def _encoded(job: Job[RenderRequest], format: str, layer: str | None, context: Context) -> bytes:
    picture = context.service.picture(job)
    if layer is not None and layer not in picture.layers:
        raise InvalidSetting(f"there is {', '.join(picture.layers)}", field="layer")
    return picture.encode(format, layer)


def statistics_headers(job: Job[RenderRequest]) -> dict[str, str]:
    """Timings for people and tools at hand, and where the rest is."""
    statistics: dict[str, Any] = dict(job.statistics or {})
    warnings = statistics.pop("warnings", [])
    statistics["warnings"] = len(warnings)
    text = json.dumps(statistics, separators=(",", ":"))
    headers = {
        "Link": f'</v1/renders/{job.id}>; rel="describedby"',
        **server_timing(job),
    }
    if len(text) <= LONGEST_HEADER:
        headers["X-Raysvc-Statistics"] = text
    return headers
