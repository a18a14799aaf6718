"""Warnings of one load: each said once, with the places that it concerns."""

_PLACES_SHOWN = 3
_WARNINGS_SHOWN = 100


class Journal:
    """Collects what a file holds that is not shown, or was repaired."""

    def __init__(self) -> None:
        self._places: dict[str, list[str]] = {}
        self._counts: dict[str, int] = {}

    def note(self, message: str, where: str) -> None:
        """Say `message` of the place `where`, a glTF path such as `materials[3].normalTexture`."""
        places = self._places.setdefault(message, [])
        self._counts[message] = self._counts.get(message, 0) + 1
        if len(places) < _PLACES_SHOWN:
            places.append(where)

    def warnings(self) -> tuple[str, ...]:
        """Return one line per message, in the order in which they were first said."""
        lines = [
            f"{', '.join(places)}{self._more(message)}: {message}"
            for message, places in self._places.items()
        ]
        if len(lines) > _WARNINGS_SHOWN:
            hidden = len(lines) - _WARNINGS_SHOWN
            lines[_WARNINGS_SHOWN:] = [f"and {hidden:,} more warnings"]
        return tuple(lines)

    def _more(self, message: str) -> str:
        hidden = self._counts[message] - len(self._places[message])
        return f" and {hidden:,} more" if hidden else ""
