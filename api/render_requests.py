"""From the body of a render to a job."""

from collections.abc import Mapping
from typing import Any

from api.schemas import RenderBody
from raysvc.errors import InvalidSetting
from raysvc.frame.probe import probe_from
from raysvc.frame.settings import checked, settings_from
from raysvc.frame.view import View
from raysvc.jobs import ContentStore, IdempotencyKey, Job, RenderRequest, RenderService
from raysvc.loading.scene_file import BUILTIN_PREFIX


def submit(
    service: RenderService, body: Mapping[str, Any], key: IdempotencyKey | None = None
) -> Job[RenderRequest]:
    """Check every part of a body and queue it; blocks.

    Raises InvalidInput, NotFound, QueueFull, Draining, StorageFull.
    """
    known = service.known(key, RenderRequest)
    if known is not None:
        return known  # though its scene may have gone since
    for name in body:
        if name not in RenderBody.model_fields:
            raise InvalidSetting("unknown key", field=name)
    if "scene" not in body:
        raise InvalidSetting("is missing", field="scene")
    settings = settings_from(_mapping(body, "settings"))
    camera = checked(View, _mapping(body, "camera"), "camera")
    environment, probe, field = body.get("environment"), None, "environment"
    if isinstance(environment, dict):
        environment, probe = probe_from(environment)
        field = "environment.environment"
    request = RenderRequest(
        scene=stored_id(body["scene"], "scene", service.scenes),
        environment=(
            None if environment is None else stored_id(environment, field, service.environments)
        ),
        camera=camera,
        settings=settings,
        probe=probe,
    )
    return service.submit(request, key)


def _mapping(body: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    value = body.get(key)
    if value is None:
        return {}
    if not isinstance(value, dict):
        raise InvalidSetting("must be an object", field=key)
    return value


def stored_id(name: Any, field: str, store: ContentStore[Any]) -> str:
    """Return the id of what is called `builtin:NAME` or by its id."""
    if not isinstance(name, str):
        raise InvalidSetting("must be an id or builtin:NAME", field=field)
    if name.startswith(BUILTIN_PREFIX):
        try:
            return store.add_builtin(name.removeprefix(BUILTIN_PREFIX))[0].id
        except InvalidSetting as error:
            raise InvalidSetting(error.message, field) from None
    return store.record(name).id
