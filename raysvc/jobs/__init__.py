"""What to do next: renders and comparisons, their queue, the worker, the stores they read.

    RenderService   everything below, wired together; what `api` talks to
      ContentStore    environments by the SHA-256 of their content, on disk and parsed
      SceneStore      the same for scenes, and for their deformed shapes
      JobRegister     all jobs, and which of them are still to be done
      Ledger          their rows in SQLite, which outlive the process
      JobQueue        a bounded line of jobs
      Worker          one thread, one job at a time
      SceneRenderer   makes pictures;  SceneComparer: measures acceleration structures
      Results         finished pictures and comparisons, in memory and in a ResultFolder
      Observer        hears what becomes of jobs
      FolderLock      one process to a data folder

Nothing here has heard of HTTP.
"""

from raysvc.jobs.durable_file import room_needed
from raysvc.jobs.ledger import IdempotencyKey, Ledger
from raysvc.jobs.model import Job, JobState
from raysvc.jobs.observer import Observer, Observers
from raysvc.jobs.queue import JobQueue
from raysvc.jobs.register import JobRegister
from raysvc.jobs.renderer import PatternRenderer, Picture, Renderer
from raysvc.jobs.requests import ComparisonRequest, RenderRequest, Request
from raysvc.jobs.result_folder import ResultFolder
from raysvc.jobs.results import Results
from raysvc.jobs.scene_comparer import SceneComparer
from raysvc.jobs.scene_renderer import SceneRenderer
from raysvc.jobs.scene_store import SceneStore
from raysvc.jobs.service import MakeRenderer, RenderService, ServiceOptions
from raysvc.jobs.store import ContentStore, Record, Upload
from raysvc.jobs.worker import Worker

__all__ = [
    "ComparisonRequest",
    "ContentStore",
    "IdempotencyKey",
    "Job",
    "JobQueue",
    "JobRegister",
    "JobState",
    "Ledger",
    "MakeRenderer",
    "Observer",
    "Observers",
    "PatternRenderer",
    "Picture",
    "Record",
    "RenderRequest",
    "RenderService",
    "Renderer",
    "Request",
    "ResultFolder",
    "Results",
    "SceneComparer",
    "SceneRenderer",
    "SceneStore",
    "ServiceOptions",
    "Upload",
    "Worker",
    "room_needed",
]
