"""What the service writes to standard error: lines for people, or JSON for machines.

Every line has the id of the request that it was written for. What is known beside the message comes
as `extra={"fields": {...}}`.
"""

import json
import logging
import sys
from datetime import UTC, datetime
from typing import Any, Final, Literal

from api.request_ids import request_id
from raysvc.jobs import Job, Observer

LogFormat = Literal["text", "json"]
LogLevel = Literal["debug", "info", "warning", "error"]

logger = logging.getLogger("raysvc.jobs")

_QUIETER: Final = ("httpx", "httpcore", "matplotlib", "PIL", "numba", "uvicorn.access")
"""Libraries whose chatter below warnings is nobody's business here."""


class JsonLines(logging.Formatter):
    """One JSON object to a line: `time`, `level`, `logger`, `message`, ids, fields."""

    def format(self, record: logging.LogRecord) -> str:
        """Show a record."""
        entry: dict[str, Any] = {
            "time": _time(record),
            "level": record.levelname.lower(),
            "logger": record.name,
            "message": record.getMessage(),
            **_known(record),
        }
        if record.exc_info:
            entry["exception"] = self.formatException(record.exc_info)
        return json.dumps(entry, default=str)


class TextLines(logging.Formatter):
    """Lines for people; what is known beside the message comes last."""

    def format(self, record: logging.LogRecord) -> str:
        """Show a record."""
        said = {"method", "path", "status"}  # what a request's message says already
        known = " ".join(
            f"{key}={value}" for key, value in _known(record).items() if key not in said
        )
        line = f"{_time(record)} {record.levelname:<7} {record.name}: {record.getMessage()} {known}"
        line = " ".join(line.split())  # whatever is told of, it begins no line of its own
        if record.exc_info:
            line += "\n" + self.formatException(record.exc_info)
        return line


class JobLog(Observer):
    """Logs what becomes of jobs."""

    def accepted(self, job: Job[Any]) -> None:
        """Ties a job to the request that asked for it."""
        logger.info("%s accepted", job.request.kind, extra={"fields": {"job_id": job.id}})

    def ended(self, job: Job[Any]) -> None:
        """Says how a job ended, and what it took."""
        fields: dict[str, Any] = {"job_id": job.id, "state": str(job.state)}
        if job.started_s is not None and job.finished_s is not None:
            fields["waited_s"] = round(job.started_s - job.created_s, 4)
            fields["seconds"] = round(job.finished_s - job.started_s, 4)
        if job.error is not None:
            fields["error"] = str(job.error)
        level = logging.INFO if job.error is None else logging.WARNING
        logger.log(level, "%s %s", job.request.kind, job.state, extra={"fields": fields})


def configure_logging(format: LogFormat, level: LogLevel) -> None:
    """Send the whole process's log to standard error."""
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(JsonLines() if format == "json" else TextLines())
    root = logging.getLogger()
    root.handlers[:] = [handler]
    root.setLevel(level.upper())
    logging.captureWarnings(True)
    for name in _QUIETER:
        logging.getLogger(name).setLevel(logging.WARNING)


def _known(record: logging.LogRecord) -> dict[str, Any]:
    id = request_id.get()
    known: dict[str, Any] = {} if id is None else {"request_id": id}
    return known | getattr(record, "fields", {})


def _time(record: logging.LogRecord) -> str:
    return datetime.fromtimestamp(record.created, UTC).isoformat(timespec="milliseconds")
