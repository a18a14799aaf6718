"""Requests that need no scene: the pattern renderer does not look at it."""

from typing import Any

from raysvc.frame.settings import Settings
from raysvc.frame.view import View
from raysvc.jobs import Job, RenderRequest


def request(scene: str = "a" * 64, **settings: Any) -> RenderRequest:
    return RenderRequest(scene, None, View(width=8, height=4), Settings(**settings))


def job(name: str = "job", **settings: Any) -> Job:
    return Job(name, request(**settings))
