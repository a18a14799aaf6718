"""Orders of tracing and shading: one picture, different costs."""

import itertools

import numpy as np
import pytest

import raysvc
from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import box, sheet, sphere
from raysvc.scene import Material, Scene, Texture, TextureRef
from tests.frame.subjects import GREY, MIRROR, RED

VIEW = {"eye": [0.5, 2.0, 5.0], "target": [0.0, 0.6, 0.0], "width": 64, "height": 36}
SETTINGS = {"bounces": 3, "occlusion_samples": 4, "aa_samples": 2}
ORDERS = list(itertools.product(("single", "multi"), ("one", "per_material")))


def mirrored_things() -> Scene:
    """Mirrors that show each other, and solid, cut-out and see-through things."""
    texels = np.full((8, 8, 4), 230, np.uint8)
    texels[(np.indices((8, 8)).sum(axis=0) % 2) == 1, 3] = 0
    materials = [
        GREY,
        MIRROR,
        RED,
        Material("mask", alpha_mode="mask", base_colour_texture=TextureRef(0), double_sided=True),
        Material("pane", (0.2, 0.4, 0.9, 0.7), alpha_mode="blend", double_sided=True),
        Material("brass", (0.9, 0.7, 0.3, 1.0), metallic=1.0, roughness=0.3),
    ]
    parts = [
        Part(sheet(6.0, 6.0, 2, 2), 0),
        Part(sphere(0.8, 20).moved([-0.9, 0.8, 0.0]), 1),
        Part(box(0.7, 0.7, 0.7).moved([0.9, 0.0, 0.6]), 2),
        Part(sheet(1.0, 1.0, 1, 1).turned(90, 0).moved([-1.6, 0.8, 1.3]), 3),
        Part(sheet(1.0, 1.0, 1, 1).turned(90, 0).moved([0.0, 0.8, 1.5]), 4),
        Part(sphere(0.5, 16).moved([0.9, 0.5, -1.0]), 5),
    ]
    return scene_of("mirrored things", parts, materials, textures=[Texture(texels)])


@pytest.fixture(scope="module")
def frames() -> dict[tuple[str, str], raysvc.Frame]:
    scene = mirrored_things()
    return {
        (passes, trees): raysvc.render(
            scene, camera=VIEW, settings=SETTINGS | {"passes": passes, "trees": trees}
        )
        for passes, trees in ORDERS
    }


@pytest.mark.parametrize("order", ORDERS[1:])
def test_every_order_gives_the_same_bytes(order, frames) -> None:
    expected = frames[ORDERS[0]]
    for layer, values in expected.layers.items():
        np.testing.assert_array_equal(frames[order].layers[layer], values)
    assert frames[order].encode("exr") == expected.encode("exr")


def test_the_statistics_say_what_each_order_costs(frames) -> None:
    costs = {order: frame.statistics.shading for order, frame in frames.items()}
    rays = frames["single", "one"].statistics.rays["reflection"]
    once = costs["single", "one"]
    assert once.wasted == 0 and 0 < once.shaded <= rays
    assert once.traces == 2 * rays  # solid triangles and those with holes
    per_material = costs["single", "per_material"]
    assert per_material.traces == 6 * rays and per_material.shaded == once.shaded
    assert costs["multi", "one"].shaded == once.shaded and costs["multi", "one"].wasted == 0
    talk = costs["multi", "per_material"]
    assert talk.traces == 6 * rays
    assert talk.wasted > 0 and talk.shaded - talk.wasted == once.shaded
    assert talk.wasted_per_pixel == talk.wasted / (64 * 36)
    assert all(c.trace_seconds > 0 and c.shade_seconds > 0 for c in costs.values())


def test_bounces_say_how_many_rays_they_took_and_what_they_brought(frames) -> None:
    statistics = frames["single", "one"].statistics
    bounces = statistics.bounces
    assert [bounce.bounce for bounce in bounces] == [1, 2, 3]
    assert sum(bounce.rays for bounce in bounces) == statistics.rays["reflection"]
    assert bounces[0].rays > bounces[1].rays > bounces[2].rays > 0
    assert bounces[0].energy > 10 * bounces[1].energy > 0 and bounces[2].energy > 0
    assert statistics.to_dict()["bounces"][0]["rays"] == bounces[0].rays
