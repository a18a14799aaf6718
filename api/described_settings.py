"""Settings as `raysvc settings` shows them, and as docs/limits.md and docs/http.md list them."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from pydantic_core import to_jsonable_python
from pydantic_settings import BaseSettings

from api.settings import settings_from_environment

ENV_PREFIX = "RAYSVC_"


class DescribedSetting(NamedTuple):
    """One environment variable."""

    name: str
    value: Any
    default: Any
    meaning: str
    source: str
    """`environment`, or `default`."""


def described_settings() -> list[DescribedSetting]:
    """Every setting, its value now and where that is from. Raises InvalidSetting."""
    return described(settings_from_environment())


def described(settings: BaseSettings) -> list[DescribedSetting]:
    """Every field of settings, values ready for JSON."""
    values: Mapping[str, Any] = settings.model_dump(mode="json")
    found = []
    for name, field in type(settings).model_fields.items():
        default = to_jsonable_python(
            field.get_default(call_default_factory=True, validated_data={})
        )
        given = name in settings.model_fields_set
        found.append(
            DescribedSetting(
                ENV_PREFIX + name.upper(),
                values[name],
                to_jsonable_python(default),
                field.description or "",
                "environment" if given else "default",
            )
        )
    return found


def shown(name: str, value: Any) -> str:
    """A value for people: bytes in MiB, thousands apart."""
    if value is None or value == []:
        return ""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return str(value)
    if name.endswith("_BYTES") and value >= 1 << 20 and value % (1 << 20) == 0:
        return f"{int(value) >> 20:,} MiB"
    return f"{value:,}" if isinstance(value, int) else f"{value:,g}"
