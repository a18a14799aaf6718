"""From the body of a comparison to a job."""

from collections.abc import Mapping
from typing import Any

from api.render_requests import stored_id
from raysvc.compare.settings import comparison_settings
from raysvc.errors import InvalidSetting
from raysvc.jobs import ComparisonRequest, IdempotencyKey, Job, RenderService


def submit(
    service: RenderService, body: Mapping[str, Any], key: IdempotencyKey | None = None
) -> Job[ComparisonRequest]:
    """Check every part of a body and queue it; blocks.

    Raises InvalidInput, Unavailable, NotFound, QueueFull, Draining, StorageFull.
    """
    known = service.known(key, ComparisonRequest)
    if known is not None:
        return known  # though its scene may have gone since
    if "scene" not in body:
        raise InvalidSetting("is missing", field="scene")
    settings = comparison_settings({key: body[key] for key in body if key != "scene"})
    scene = stored_id(body["scene"], "scene", service.scenes)
    return service.submit_comparison(ComparisonRequest(scene, settings), key)
