"""Who hears what becomes of jobs: metrics and logs live elsewhere, and hang on here."""

from typing import Any

from raysvc.jobs.model import Job


class Observer:
    """Hears everything and does nothing; override what you want to know of.

    Calls come from any thread; they must be quick and must not raise.
    """

    def accepted(self, job: Job[Any]) -> None:
        """A job was accepted; it may have its result already, if that was held."""

    def ended(self, job: Job[Any]) -> None:
        """An accepted job is done, failed or cancelled: its times, statistics, error are there."""


class Observers(Observer):
    """Several of them, told one after the other."""

    def __init__(self, *observers: Observer) -> None:
        self._observers = observers

    def accepted(self, job: Job[Any]) -> None:
        """Pass it on."""
        for observer in self._observers:
            observer.accepted(job)

    def ended(self, job: Job[Any]) -> None:
        """Pass it on."""
        for observer in self._observers:
            observer.ended(job)
