"""How far a key reaches."""

from enum import StrEnum


class Scope(StrEnum):
    """From the least to the most; each holds those before it."""

    READ = "read"
    """Look at scenes, renders, comparisons, metrics."""
    RENDER = "render"
    """Send scenes, ask for work, cancel it."""
    ADMIN = "admin"
    """Delete what others may be using."""

    def includes(self, other: "Scope") -> bool:
        """May a key of this scope do what that one is for?"""
        order = tuple(Scope)
        return order.index(self) >= order.index(other)
