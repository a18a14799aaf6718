import json

from raysvc.compare.compare import compare
from raysvc.compare.settings import ComparisonSettings
from raysvc.compare.tables import table
from raysvc.frame.view import View
from raysvc.jobs.kept_comparison import comparison_from, comparison_record
from raysvc.loading import load_scene


def test_a_comparison_is_read_as_it_was_written() -> None:
    settings = ComparisonSettings(
        count=50,
        rounds=1,
        builds=1,
        structures=("bvh", "kd"),
        heat_map=True,
        scaling=True,
        camera=View(width=8, height=6),
    )
    measured = compare(load_scene("builtin:cornell"), settings, source="builtin:cornell")
    about, arrays = comparison_record(measured)
    again = comparison_from(json.loads(json.dumps(about)), arrays)
    assert again.to_dict() == measured.to_dict()
    assert type(again.structures[0]) is type(measured.structures[0])
    assert list(again.heat_maps) == list(measured.heat_maps)
    for name, heat_map in measured.heat_maps.items():
        assert (again.heat_maps[name].node_steps == heat_map.node_steps).all()
        assert (again.heat_maps[name].triangle_tests == heat_map.triangle_tests).all()
    for format in ("csv", "md", "json"):
        assert table(again, format) == table(measured, format)
