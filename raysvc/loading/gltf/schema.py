"""Turning JSON into pygltflib's document classes, checking every type on the way.

pygltflib's own decoder checks nothing and takes 0.2 ms per object; its classes say what there is,
and this fills them, naming the place of whatever is wrong.
"""

import math
import types
from collections.abc import Callable
from dataclasses import MISSING, dataclass, fields
from functools import cache
from typing import Any, Literal, TypeVar, Union, cast, get_args, get_origin, get_type_hints

import pygltflib

from raysvc.errors import InvalidScene

Decoded = TypeVar("Decoded")
Check = Callable[[object, str], Any]

_LARGEST_INTEGER = 1 << 53
_LONGEST_NAME = 1000

_LENGTHS = {
    "Node.translation": 3,
    "Node.rotation": 4,
    "Node.scale": 3,
    "Node.matrix": 16,
    "PbrMetallicRoughness.baseColorFactor": 4,
    "Material.emissiveFactor": 3,
    "TextureTransform.offset": 2,
    "TextureTransform.scale": 2,
    "Volume.attenuationColor": 3,
    "Light.color": 3,
}
# Not Optional in pygltflib though the specification does not require them.
_OPTIONAL = {"Image.uri", "Image.mimeType", "Image.bufferView", "GLTF2.scene"}
# Never looked into: free form, or belonging to features that are only named in warnings.
_UNCHECKED = {"extras", "animations", "skins", "min", "max", "weights"}


@dataclass(frozen=True, slots=True)
class _Field:
    name: str
    check: Check
    required: bool


def decode(kind: type[Decoded], value: object, path: str) -> Decoded:
    """Return a `kind` (a dataclass of pygltflib or of ours) made from a JSON object.

    Parameters
    ----------
    kind
        class to make
    value
        what json.loads returned; keys that the class does not have are ignored, null is absent
    path
        of `value` in the document, for errors

    Raises
    ------
    InvalidScene
        a value of the wrong type or length, not finite, or missing
    """
    if not isinstance(value, dict):
        raise _wrong("an object", value, path)
    here = f"{path}." if path else ""
    given: dict[str, Any] = {}
    for each in _plan(cast(Any, kind)):
        found = value.get(each.name)
        if found is not None:
            given[each.name] = each.check(found, here + each.name)
        elif each.required:
            raise InvalidScene("is missing", here + each.name)
    return kind(**given)


@cache
def _plan(kind: Any) -> tuple[_Field, ...]:
    hints = get_type_hints(kind)
    plan = []
    for each in fields(kind):
        name = f"{kind.__name__}.{each.name}"
        hint, optional = _without_none(hints[each.name])
        without_default = each.default in (None, MISSING) and each.default_factory is MISSING
        required = without_default and not optional and name not in _OPTIONAL
        required |= hint is pygltflib.Attributes
        check = _unchecked if each.name in _UNCHECKED else _check_of(hint, _LENGTHS.get(name))
        plan.append(_Field(each.name, check, required))
    return tuple(plan)


def _without_none(hint: Any) -> tuple[Any, bool]:
    if get_origin(hint) in (Union, types.UnionType):
        rest = [each for each in get_args(hint) if each is not type(None)]
        return rest[0], True
    return hint, False


def _check_of(hint: Any, length: int | None) -> Check:
    if get_origin(hint) is list:
        return _list_of(_check_of(get_args(hint)[0], None), length)
    if hint is pygltflib.Attributes:
        return _attributes
    if get_origin(hint) is dict:
        return _object
    if get_origin(hint) is Literal:
        return _one_of(get_args(hint))
    if hint in _SCALARS:
        return _SCALARS[hint]

    def nested(value: object, path: str) -> Any:
        return decode(hint, value, path)

    return nested


def _list_of(check: Check, length: int | None) -> Check:
    def check_list(value: object, path: str) -> list[Any]:
        if not isinstance(value, list):
            raise _wrong("an array", value, path)
        if length is not None and len(value) != length:
            raise InvalidScene(f"has {len(value)} values instead of {length}", path)
        if length is not None:
            return [check(each, path) for each in value]
        return [check(each, f"{path}[{number}]") for number, each in enumerate(value)]

    return check_list


def _one_of(words: tuple[str, ...]) -> Check:
    def check_word(value: object, path: str) -> Any:
        if value not in words:
            raise InvalidScene(f"is not one of {', '.join(words)}", path)
        return value

    return check_word


def _unchecked(value: object, path: str) -> Any:
    return value


def _object(value: object, path: str) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise _wrong("an object", value, path)
    return value


def _attributes(value: object, path: str) -> dict[str, int]:
    return {
        name: _integer(each, f"{path}.{name[:_LONGEST_NAME]}")
        for name, each in _object(value, path).items()
    }


def _integer(value: object, path: str) -> int:
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    if not isinstance(value, int) or isinstance(value, bool):
        raise _wrong("an integer", value, path)
    if abs(value) > _LARGEST_INTEGER:
        raise InvalidScene("is too large an integer", path)
    return value


def _number(value: object, path: str) -> float:
    if not isinstance(value, int | float) or isinstance(value, bool):
        raise _wrong("a number", value, path)
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise InvalidScene("is not finite", path)
    return number


def _boolean(value: object, path: str) -> bool:
    if not isinstance(value, bool):
        raise _wrong("true or false", value, path)
    return value


def _string(value: object, path: str) -> str:
    if not isinstance(value, str):
        raise _wrong("a string", value, path)
    return value


def _wrong(expected: str, value: object, path: str) -> InvalidScene:
    found = {dict: "an object", list: "an array", str: "a string", bool: "true or false"}
    return InvalidScene(f"is {found.get(type(value), 'a number')} instead of {expected}", path)


_SCALARS: dict[Any, Check] = {
    int: _integer,
    float: _number,
    bool: _boolean,
    str: _string,
    Any: _unchecked,
}
