"""What can be chosen, and what a wrong choice says."""

import numpy as np
import pytest
from pydantic import BaseModel

from raysvc.accel import registry
from raysvc.accel.base import Triangles
from raysvc.accel.brute import BruteParams
from raysvc.accel.registry import FASTEST_FIRST, STRUCTURES, Entry, build, choose
from raysvc.errors import InvalidSetting, Unavailable

ONE = Triangles(np.eye(3, dtype=np.float32), np.array([[0, 1, 2]], np.int32))


def test_every_structure_is_ranked():
    assert sorted(FASTEST_FIRST) == sorted(STRUCTURES)


def test_every_parameter_is_described_and_refuses_strangers():
    for entry in STRUCTURES.values():
        assert issubclass(entry.params, BaseModel)
        assert entry.params.model_config["extra"] == "forbid"
        assert all(field.description for field in entry.params.model_fields.values())


def test_an_unknown_structure_names_the_known_ones():
    with pytest.raises(InvalidSetting, match=r"structure: unknown structure 'octree'.*brute"):
        build("octree", ONE)


@pytest.mark.parametrize(
    ("name", "parameters", "field"),
    [
        ("embree", {"robust": "perhaps"}, "structure.embree.robust"),
        ("embree", {"leaf_size": 4}, "structure.embree.leaf_size"),
        ("brute", {"leaf_size": 4}, "structure.brute.leaf_size"),
    ],
)
def test_a_wrong_parameter_is_named(name, parameters, field):
    if STRUCTURES[name].why_not():
        pytest.skip("not on this machine")
    with pytest.raises(InvalidSetting) as caught:
        build(name, ONE, parameters)
    assert caught.value.field == field


def test_auto_takes_the_fastest_that_this_machine_has(monkeypatch):
    assert choose("auto") == next(n for n in FASTEST_FIRST if STRUCTURES[n].why_not() is None)
    missing = Entry(STRUCTURES["embree"].build, BruteParams, "", requires="no_such_package")
    monkeypatch.setattr(registry, "STRUCTURES", {**STRUCTURES, "embree": missing})
    assert choose("auto") == "bvh"
    with pytest.raises(Unavailable, match="no_such_package"):
        choose("embree")
