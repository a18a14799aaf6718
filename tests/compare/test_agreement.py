"""All structures find the same surfaces on the park, along rays of every kind."""

import numpy as np
import pytest

from raysvc.accel.base import Accelerator, Triangles, nearest
from raysvc.accel.registry import STRUCTURES, build
from raysvc.builtin import BUILTIN_SCENES
from raysvc.compare.ray_sets import RAY_KINDS, RayKind, ray_set
from raysvc.frame.view import View, camera_from
from raysvc.scene import Scene

COUNT = 1 << 15
NAMES = [name for name, entry in STRUCTURES.items() if name != "brute" and entry.why_not() is None]


@pytest.fixture(scope="module")
def park() -> Scene:
    return BUILTIN_SCENES["torus_park"]()


@pytest.fixture(scope="module")
def triangles(park: Scene) -> Triangles:
    return Triangles(park.positions, park.triangles)


@pytest.fixture(scope="module")
def structures(triangles: Triangles) -> dict[str, Accelerator]:
    return {name: build(name, triangles) for name in NAMES}


@pytest.mark.slow
@pytest.mark.parametrize("kind", RAY_KINDS)
def test_distances_agree_to_one_in_ten_thousand(
    park: Scene, triangles: Triangles, structures: dict[str, Accelerator], kind: RayKind
) -> None:
    camera = camera_from(View(gltf_camera="default"), park)
    rays = ray_set(kind, park, camera, COUNT, seed=1).rays
    found = {name: nearest(each, triangles, rays) for name, each in structures.items()}
    first = found[NAMES[0]]
    assert (first.triangle >= 0).any()
    for hits in found.values():
        both = np.isfinite(hits.t) & np.isfinite(first.t)
        differs = np.isfinite(hits.t) != np.isfinite(first.t)
        differs[both] = np.abs(hits.t[both] - first.t[both]) > 1e-4 * first.t[both]
        assert differs.sum() <= 1e-5 * COUNT + 1
