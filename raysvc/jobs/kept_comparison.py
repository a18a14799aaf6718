"""A comparison as it is kept on the disk, and as it comes back."""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any, Final

from pydantic import TypeAdapter

from raysvc.compare.heat_map import HeatMap
from raysvc.compare.result import Comparison, RayFigures, Scaling, StructureFigures
from raysvc.compare.talk_2009 import Talk
from raysvc.jobs.array_file import Arrays

HEAT_MAPS: Final = "heat_maps"

FIGURES: Final[Mapping[str, TypeAdapter[Any]]] = {
    "rays": TypeAdapter(RayFigures),
    "structures": TypeAdapter(tuple[StructureFigures, ...]),
    "scaling": TypeAdapter(Scaling | None),
    "talk_2009": TypeAdapter(Talk | None),
}
"""The fields of a comparison that are more than JSON already is."""


def comparison_record(comparison: Comparison) -> tuple[dict[str, Any], Arrays]:
    """Return what is said about a comparison, ready for JSON, and its heat maps as arrays."""
    about: dict[str, Any] = {}
    for field in fields(comparison):
        value = getattr(comparison, field.name)
        if field.name in FIGURES:
            about[field.name] = FIGURES[field.name].dump_python(value, mode="json")
        elif field.name != HEAT_MAPS:
            about[field.name] = dict(value) if isinstance(value, Mapping) else value
    arrays = {
        f"{name}/{part}": array
        for name, heat_map in comparison.heat_maps.items()
        for part, array in (
            ("node_steps", heat_map.node_steps),
            ("triangle_tests", heat_map.triangle_tests),
        )
    }
    return about, arrays


def comparison_from(about: Mapping[str, Any], arrays: Arrays) -> Comparison:
    """Return the comparison that a record was made of."""
    values = {
        name: FIGURES[name].validate_python(value) if name in FIGURES else value
        for name, value in about.items()
    }
    names = dict.fromkeys(name.rpartition("/")[0] for name in arrays)
    heat_maps = {
        name: HeatMap(arrays[f"{name}/node_steps"], arrays[f"{name}/triangle_tests"])
        for name in names
    }
    return Comparison(**values, heat_maps=heat_maps)
