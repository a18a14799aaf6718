"""What is around a scene: from what a caller gives for an environment."""

import functools
from collections.abc import Mapping
from typing import Final

from raysvc.builtin import BUILTIN_ENVIRONMENTS
from raysvc.errors import InvalidSetting
from raysvc.frame.probe import FIELD, Probe, probe_from
from raysvc.scene import Environment

DEFAULT_ENVIRONMENT: Final = "clear_sky"
_PREFIX: Final = "builtin:"


def surroundings(environment: object) -> tuple[Environment, Probe | None]:
    """What is far away, and the probe if one was asked for.

    A mapping holds the fields of a `Probe`, and `environment`: an Environment, `builtin:NAME`, or
    None. Raises InvalidSetting.
    """
    if environment is None or isinstance(environment, Environment):
        return environment or default_environment(), None
    if not isinstance(environment, Mapping):
        kind = type(environment).__name__
        raise InvalidSetting(f"must be an Environment or a mapping, not {kind}", FIELD)
    base, probe = probe_from(environment)
    if isinstance(base, str) and base.startswith(_PREFIX):
        base = _builtin_environment(base.removeprefix(_PREFIX))
    if base is not None and not isinstance(base, Environment):
        raise InvalidSetting("must be an Environment or builtin:NAME", f"{FIELD}.environment")
    return base or default_environment(), probe


def default_environment() -> Environment:
    """Return the environment of frames that were given none."""
    return _builtin_environment(DEFAULT_ENVIRONMENT)


@functools.cache
def _builtin_environment(name: str) -> Environment:
    """One object for each name, so that its tables are kept."""
    if name not in BUILTIN_ENVIRONMENTS:
        known = ", ".join(BUILTIN_ENVIRONMENTS)
        raise InvalidSetting(f"no built-in {name!r}; there are {known}", f"{FIELD}.environment")
    return BUILTIN_ENVIRONMENTS[name]()
