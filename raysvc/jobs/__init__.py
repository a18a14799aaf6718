"""What to render next: jobs, their queue, the worker that takes them, the stores they read.

    RenderService   everything below, wired together; what `api` talks to
      ContentStore    scenes and environments by the SHA-256 of their content, on disk and parsed
      JobQueue        a bounded line of jobs
      Worker          one thread, one job at a time
      Results         finished pictures, the least recently used ones make room

Nothing here has heard of HTTP.
"""

from raysvc.jobs.model import Job, JobState, RenderRequest
from raysvc.jobs.queue import JobQueue
from raysvc.jobs.renderer import PatternRenderer, Picture, Renderer
from raysvc.jobs.results import Results
from raysvc.jobs.scene_renderer import SceneRenderer
from raysvc.jobs.service import MakeRenderer, RenderService, ServiceOptions
from raysvc.jobs.store import ContentStore, Record, Upload
from raysvc.jobs.worker import Worker

__all__ = [
    "ContentStore",
    "Job",
    "JobQueue",
    "JobState",
    "MakeRenderer",
    "PatternRenderer",
    "Picture",
    "Record",
    "RenderRequest",
    "RenderService",
    "Renderer",
    "Results",
    "SceneRenderer",
    "ServiceOptions",
    "Upload",
    "Worker",
]
