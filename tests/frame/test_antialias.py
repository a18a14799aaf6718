"""Anti-aliasing of whole frames: which pixels are flagged, and that it helps where it should."""

import numpy as np

import raysvc
from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import box, sheet
from raysvc.scene import Material, PunctualLight
from tests.frame.subjects import GREY, MIRROR, constant_environment

VIEW = {"eye": [0.0, 2.0, 5.0], "target": [0.0, 0.0, 0.0], "width": 64, "height": 48}
PLAIN = {"occlusion_samples": 0, "aa_samples": 16}


def before_a_mirror() -> raysvc.Scene:
    """A slanted glowing beam above a mirror floor, out of sight but for its reflection."""
    glow = Material(base_colour=(0, 0, 0, 1), metallic=0.0, emissive=(1.0, 1.0, 1.0))
    beam = box(8.0, 0.5, 0.5).turned(20, 1).moved([0, 4.0, -4.0])
    return scene_of("mirror", [Part(sheet(12, 12, 1, 1), 0), Part(beam, 1)], [MIRROR, glow])


def rendered(aa: str) -> raysvc.Frame:
    return raysvc.render(before_a_mirror(), constant_environment(0.1), VIEW, PLAIN | {"aa": aa})


def error(frame: raysvc.Frame, truth: raysvc.Frame) -> float:
    return float(np.square(frame.layers["beauty"] - truth.layers["beauty"]).mean())


def test_edges_in_a_mirror_are_found_and_smoothed() -> None:
    none, edges, full = (rendered(aa) for aa in ("none", "edges", "full"))
    floor = none.layers["object"] == 0
    flagged = (edges.layers["edge"] > 0) & floor
    # The floor is one flat face: what is flagged on it is in the mirror.
    assert 10 < flagged.sum() < 0.3 * floor.sum()
    assert edges.statistics.edge_fraction == np.mean(edges.layers["edge"])
    assert error(edges, full) < 0.1 * error(none, full)


def test_directional_lies_between_none_and_edges_in_a_mirror_and_shades_nothing() -> None:
    none, directional, edges, full = (
        rendered(aa) for aa in ("none", "directional", "edges", "full")
    )
    assert error(edges, full) < error(directional, full) < error(none, full)
    shading = ("shadow", "occlusion", "reflection", "refraction")
    traced = (frame.statistics.rays for frame in (directional, none))
    one, other = ({kind: rays.get(kind) for kind in shading} for rays in traced)
    assert one == other
    assert (directional.layers["edge"] == edges.layers["edge"]).all()


def test_borders_that_cannot_be_seen_take_no_samples() -> None:
    """Two boxes of one colour, one in front of the other, that glow alike."""
    glow = Material(base_colour=(0, 0, 0, 1), metallic=0.0, emissive=(1.0, 1.0, 1.0), ior=1.0)
    scene = scene_of(
        "alike",
        [Part(box(9.0, 9.0, 0.1).moved([0, -4.5, -2]), 0), Part(box(1.0, 1.0, 0.1), 1)],
        [glow, glow],
    )
    frame = raysvc.render(scene, constant_environment(0.0), VIEW, PLAIN)
    assert len(np.unique(frame.layers["object"])) == 2
    assert frame.statistics.edge_fraction == 0.0


def shaded_floor(height: float) -> raysvc.Scene:
    """A grey floor under a lamp, and a slanted plate, out of sight, that shades half of it."""
    plate = sheet(6.0, 6.0, 1, 1).moved([3.0, 0.0, 0.0]).turned(20, 1).moved([0.0, height, 0.0])
    lamp = PunctualLight("point", (60.0, 60.0, 60.0), position=(0.0, 4.0, 0.0))
    parts = [Part(sheet(40, 400, 1, 1), 0), Part(plate, 0)]
    return scene_of("shaded", parts, [GREY], lights=[lamp])


def test_edges_of_shadows_are_found_and_smoothed() -> None:
    scene, dark = shaded_floor(3.0), constant_environment(0.1)
    none, edges, full = (
        raysvc.render(scene, dark, VIEW | {"target": [0, -1, 0]}, PLAIN | {"aa": aa})
        for aa in ("none", "edges", "full")
    )
    # No outline is on the floor but that of the shadow.
    assert set(np.unique(none.layers["object"])) == {0}
    assert 0.005 < edges.statistics.edge_fraction < 0.1
    assert error(edges, full) < 0.02 * error(none, full)


def test_directional_shows_what_samples_cover() -> None:
    """Slanted card of one colour: the mean of eight samples' coverage, and better."""
    white = Material(unlit=True, double_sided=True)
    card = sheet(3.0, 2.0, 1, 1).turned(90, 0).turned(17, 2)
    scene = scene_of("card", [Part(card, 0)], [white])
    none, directional, full = (
        raysvc.render(scene, constant_environment(0.0), VIEW, PLAIN | {"aa": aa})
        for aa in ("none", "directional", "full")
    )
    assert error(directional, full) < 0.3 * error(none, full)
    assert directional.statistics.rays["primary"] > none.statistics.rays.get("primary", 0)


def test_leaves_smaller_than_a_pixel_are_found_and_smoothed(rng: np.random.Generator) -> None:
    """Small slanted cards at random before the sky."""
    leaves = [
        Part(
            sheet(0.05, 0.05, 1, 1)
            .turned(float(rng.uniform(0, 180)), 0)
            .turned(float(rng.uniform(0, 180)), 2)
            .moved(rng.uniform(-1.5, 1.5, 3)),
            0,
        )
        for _ in range(600)
    ]
    scene = scene_of("leaves", leaves, [GREY])
    light = constant_environment(1.0)
    none, edges, full = (
        raysvc.render(scene, light, VIEW, PLAIN | {"aa": aa}) for aa in ("none", "edges", "full")
    )
    assert error(edges, full) < 0.2 * error(none, full)


def test_what_no_pixel_centre_shows_is_found_by_all_samples() -> None:
    """A card of a third of a pixel, between the centres."""
    white = Material(unlit=True, double_sided=True)
    pixel_m = 2.0 * np.sqrt(29.0) * np.tan(np.radians(20.0)) / 48
    scene = scene_of("speck", [Part(sheet(0.3 * pixel_m, 0.3 * pixel_m, 1, 1), 0)], [white])
    frame = raysvc.render(
        scene, constant_environment(0.0), VIEW, PLAIN | {"aa": "full", "aa_samples": 64}
    )
    assert (frame.layers["id"] < 0).all()
    assert 0.01 < frame.layers["beauty"][..., 0].sum() < 0.1
