"""What is asked of comparisons, and what their answers look like."""

from typing import Any

from pydantic import ConfigDict, Field

from api.schemas import JobResource, job_fields, results_of
from raysvc.compare.settings import ComparisonSettings
from raysvc.jobs import ComparisonRequest, Job


class ComparisonBody(ComparisonSettings):
    """Asks for acceleration structures to be measured."""

    model_config = ConfigDict(title="ComparisonBody")

    scene: str = Field(description="A scene's id, or `builtin:NAME`.")


class ComparisonResource(JobResource):
    """A comparison: how far it is, and what was measured. Figures are null until it is done."""

    progress: float = Field(description="How much of everything is done, 0..1; 1 when done.")
    scene: str
    settings: dict[str, Any]
    rays: dict[str, Any] = Field(description="`kind`, `count`, `seed`.")
    query: str | None = Field(None, description="`nearest` or `occluded`.")
    triangles: int | None = None
    materials: int | None = None
    threads: int | None = Field(None, description="What `all_threads` means.")
    rounds: int | None = None
    structures: list[dict[str, Any]] | None = Field(
        None, description="`name`, `trees`, `build`, `traversal` of each."
    )
    sampled: dict[str, int] | None = Field(
        None, description="From how many `epo_triangles` and `lcv_rays` `epo` and `lcv` come."
    )
    steps: dict[str, str] | None = Field(None, description="What a node step is, by structure.")
    scaling: dict[str, Any] | None = None
    talk_2009: dict[str, Any] | None = Field(
        None, description="The talk's figures, for its scene with a tree per material."
    )
    machine: dict[str, Any] | None = None
    seconds: float | None = None
    renderer_version: str | None = None


def result_links(request: ComparisonRequest) -> dict[str, str]:
    """What there will be to look at."""
    links = {"table": "table.csv", "chart": "chart.svg"}
    return links | {"heat_map": "heat_map.png"} if request.settings.heat_map else links


def comparison_resource(job: Job[ComparisonRequest], position: int | None) -> ComparisonResource:
    """Present a comparison."""
    settings = job.request.settings
    known = job_fields(job, position, result_links(job.request))
    figures = results_of(job, known["state"]) or {}
    figures |= {
        "scene": job.request.scene,
        "rays": {"kind": settings.rays, "count": settings.count, "seed": settings.seed},
    }
    return ComparisonResource(**known, settings=settings.model_dump(mode="json"), **figures)
