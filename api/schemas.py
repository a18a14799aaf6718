"""What answers look like. The names are the core's."""

from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Any

from pydantic import BaseModel, ConfigDict, Field

from api.problems import error_body
from raysvc.accel.registry import Entry
from raysvc.frame.probe import Probe
from raysvc.frame.settings import Settings
from raysvc.frame.view import View
from raysvc.jobs import Job, JobState, Record, RenderRequest, Request


class BuiltinBody(BaseModel):
    """Asks for a thing that is made in code."""

    model_config = ConfigDict(extra="forbid")

    builtin: str = Field(description="Its name, such as `torus_park`.")


class ProbeBody(Probe):
    """Asks for an environment that is captured from a point of the scene."""

    environment: str | None = Field(
        None, description="What is around the scene: an id, or `builtin:NAME`."
    )


class RenderBody(BaseModel):
    """Asks for a picture."""

    scene: str = Field(description="A scene's id, or `builtin:NAME`.")
    environment: str | ProbeBody | None = Field(
        None,
        description="An environment's id, or `builtin:NAME`, the clear sky by default; or a probe.",
    )
    camera: View = Field(
        default_factory=View, description="From where; framed on the bounds by default."
    )
    settings: Settings = Field(default_factory=Settings, description="How.")


class ProblemBody(BaseModel):
    """An RFC 9457 problem."""

    type: str
    title: str
    status: int
    detail: str
    instance: str
    field: str | None = Field(description="What was wrong, in the request's own words.")
    retryable: bool = Field(description="Whether the same request may succeed later.")
    request_id: str | None = Field(description="What the service's log calls the request.")


class StoredResource(BaseModel):
    """What scenes and environments have in common."""

    id: str = Field(description="SHA-256 of the content.")
    created: str = Field(description="When it was first sent (RFC 3339).")
    builtin: str | None = Field(description="Its name, if it is made in code.")
    name: str
    warnings: list[str] = Field(description="What is in the file but not supported.")
    links: dict[str, str]


class SceneResource(StoredResource):
    """A scene."""

    rest: str | None = Field(
        description="Of a scene whose vertices were moved, the id of that which it was made from."
    )
    triangles: int
    vertices: int
    objects: int
    bounds: dict[str, list[float]] = Field(description="`min` and `max` corner, in metres.")
    materials: list[dict[str, Any]]
    textures: list[dict[str, Any]]
    cameras: list[dict[str, Any]]
    lights: list[dict[str, Any]]


class EnvironmentResource(StoredResource):
    """An environment."""

    width: int
    height: int
    mean_radiance: list[float] = Field(description="Linear RGB, weighted by solid angle.")
    max_radiance: float


class JobResource(BaseModel):
    """How far something is that takes its time."""

    id: str
    state: JobState
    stage: str | None = Field(description="What runs now.")
    progress: float = Field(description="How much of the stage is done, 0..1; 1 when done.")
    position: int | None = Field(description="Jobs that run before this one, while it waits.")
    attempts: int = Field(description="How often it was begun: again, when the process died.")
    heartbeat: str | None = Field(description="When it was last seen to get on, while it runs.")
    created: str
    started: str | None
    finished: str | None
    error: dict[str, Any] | None = Field(description="Why it failed.")
    links: dict[str, str]


class RenderResource(JobResource):
    """A render: how far it is, and what it took."""

    scene: str
    environment: str | dict[str, Any] | None = Field(
        description="Its id; with a probe, that as it was asked for."
    )
    camera: dict[str, Any]
    settings: dict[str, Any]
    statistics: dict[str, Any] | None = Field(
        description="Timings per stage, rays and more, when done."
    )
    warnings: list[str]


class StructureResource(BaseModel):
    """An acceleration structure of the registry."""

    name: str
    summary: str
    available: bool
    why_not: str | None = Field(description="Why this machine cannot run it.")
    parameters: dict[str, Any] = Field(description="JSON schema.")


class StructureList(BaseModel):
    """The registry."""

    structures: list[StructureResource]


class SceneList(BaseModel):
    """Scenes, newest first."""

    scenes: list[SceneResource]


class EnvironmentList(BaseModel):
    """Environments, newest first."""

    environments: list[EnvironmentResource]


class Health(BaseModel):
    """Whether the service lives, or is ready."""

    status: str


def scene_resource(record: Record) -> SceneResource:
    """Present a scene."""
    stored = _stored(record, "scenes")
    stored["links"]["positions"] = f"{stored['links']['self']}/positions"
    if record.rest is not None:
        stored["links"]["rest"] = f"/v1/scenes/{record.rest}"
    return SceneResource(**stored, rest=record.rest, **record.summary)


def environment_resource(record: Record) -> EnvironmentResource:
    """Present an environment."""
    return EnvironmentResource(**_stored(record, "environments"), **record.summary)


def job_fields(job: Job[Request], position: int | None, links: Mapping[str, str]) -> dict[str, Any]:
    """What every job says of itself; `links` lead to its result, once it is there."""
    state = job.state  # read first: what belongs to a state is set before the state is
    running = state is JobState.RUNNING
    path = f"/v1/{job.request.kind}s/{job.id}"
    there = {name: f"{path}/{tail}" for name, tail in links.items() if state is JobState.DONE}
    events = {} if job.finished.done() else {"events": f"{path}/events"}
    return {
        "id": job.id,
        "state": state,
        "stage": job.stage if running else None,
        "progress": 1.0 if state is JobState.DONE else job.stage_fraction,
        "position": position,
        "attempts": job.attempts,
        "heartbeat": _time(job.heartbeat_s) if running and job.heartbeat_s else None,
        "created": _time(job.created_s),
        "started": _time(job.started_s) if job.started_s else None,
        "finished": _time(job.finished_s) if job.finished_s else None,
        "error": error_body(job.error) if job.error is not None else None,
        "links": {"self": path, **events, **there},
    }


def render_resource(job: Job[RenderRequest], position: int | None) -> RenderResource:
    """Present a render."""
    known = job_fields(job, position, {"image": "image"})
    statistics = results_of(job, known["state"])
    return RenderResource(
        **known,
        scene=job.request.scene,
        environment=_environment_asked(job.request),
        camera=job.request.camera.model_dump(mode="json"),
        settings=job.request.settings.model_dump(mode="json"),
        statistics=statistics,
        warnings=list(statistics.get("warnings", [])) if statistics else [],
    )


def results_of(job: Job[Any], state: JobState) -> dict[str, Any] | None:
    """What is known of a job that was seen in a state: nothing before that said it was done."""
    return None if state is not JobState.DONE else dict(job.statistics or {})


def _environment_asked(request: RenderRequest) -> str | dict[str, Any] | None:
    if request.probe is None:
        return request.environment
    return {**request.probe.model_dump(mode="json"), "environment": request.environment}


def structure_resource(name: str, entry: Entry) -> StructureResource:
    """Present an entry of the registry."""
    why_not = entry.why_not()
    return StructureResource(
        name=name,
        summary=entry.summary,
        available=why_not is None,
        why_not=why_not,
        parameters=entry.params.model_json_schema(),
    )


def _stored(record: Record, collection: str) -> dict[str, Any]:
    return {
        "id": record.id,
        "created": _time(record.created_s),
        "builtin": record.builtin,
        "links": {"self": f"/v1/{collection}/{record.id}"},
    }


def _time(seconds: float) -> str:
    return datetime.fromtimestamp(seconds, UTC).isoformat(timespec="milliseconds")
