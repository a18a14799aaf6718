"""Whole frames: closed forms, orientation, layers, determinism, stopping."""

import threading

import numpy as np
import pytest

import raysvc
from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import box, sheet, sphere
from raysvc.errors import Cancelled, DeadlineExceeded, InvalidSetting
from raysvc.parallel import Control
from raysvc.scene import Environment, Material, PunctualLight
from tests.frame.subjects import GREY, VIEW, ball, constant_environment, still_life
from tests.oracles.directional_albedo import directional_albedo

PLAIN = {"aa": "none", "occlusion_samples": 0, "bounces": 0}
FRONT = {"eye": [0.0, 0.0, 4.0], "target": [0.0, 0.0, 0.0], "width": 48, "height": 48}


def test_the_same_request_gives_the_same_bytes_with_1_2_and_5_threads() -> None:
    scene, view = still_life(), VIEW | {"aperture_radius": 0.05}
    encoded = [
        raysvc.render(scene, camera=view, settings={"threads": threads, "bounces": 2})
        for threads in (1, 2, 5)
    ]
    assert len({frame.encode("exr") for frame in encoded}) == 1
    assert len({frame.encode("png") for frame in encoded}) == 1


@pytest.mark.parametrize("metallic", [0.0, 1.0])
@pytest.mark.parametrize("roughness", [0.1, 0.4, 1.0])
def test_a_ball_under_constant_light_shows_the_directional_albedo(
    metallic: float, roughness: float
) -> None:
    material = Material(base_colour=(0.8, 0.5, 0.2, 1.0), metallic=metallic, roughness=roughness)
    frame = raysvc.render(ball(material), constant_environment(), FRONT, PLAIN)
    seen = frame.layers["id"] >= 0
    rows, cols = np.nonzero(seen)
    tan = np.tan(np.radians(20))
    towards = np.stack(
        [(cols + 0.5 - 24) / 24 * tan, (24 - rows - 0.5) / 24 * tan, -np.ones(len(rows))], axis=1
    )
    towards /= np.linalg.norm(towards, axis=1)[:, None]
    cosine = -np.einsum("nk,nk->n", towards, frame.layers["normal"][seen])
    for near in (0.9, 0.6, 0.35):
        chosen = np.abs(cosine - near) < 0.02
        assert chosen.any()
        expected = directional_albedo(
            cosine[chosen].mean(),
            base_colour=(0.8, 0.5, 0.2),
            metallic=metallic,
            roughness=roughness,
        )
        shown = frame.layers["beauty"][seen][chosen][:, :3].mean(axis=0)
        np.testing.assert_allclose(shown, expected, rtol=0.01)


def test_zero_aperture_is_the_identity() -> None:
    scene = still_life()
    sharp = raysvc.render(scene, camera=VIEW | {"aperture_radius": 0.0})
    none = raysvc.render(scene, camera=VIEW | {"aperture_radius": 0.2}, settings={"lens": "none"})
    assert np.array_equal(sharp.layers["beauty"], none.layers["beauty"])
    assert "coc" not in sharp.layers
    assert sharp.statistics.max_coc_px == 0.0


def test_an_aperture_blurs_what_is_out_of_focus_only() -> None:
    scene = still_life()
    focus = {"focus_distance": 5.2}
    sharp = raysvc.render(scene, camera=VIEW)
    blurred = raysvc.render(scene, camera=VIEW | focus | {"aperture_radius": 0.3})
    coc = np.abs(blurred.layers["coc"])
    assert blurred.statistics.max_coc_px == pytest.approx(coc.max())
    floor_in_front = (blurred.layers["object"] == 0) & (blurred.layers["coc"] < -2)
    steps = {
        name: np.square(np.diff(frame.layers["beauty"][..., 0], axis=1))[
            floor_in_front[:, 1:]
        ].mean()
        for name, frame in (("sharp", sharp), ("blurred", blurred))
    }
    assert steps["blurred"] < 0.7 * steps["sharp"]
    in_focus = coc < 1
    near_focus = in_focus & (np.abs(blurred.layers["beauty"] - sharp.layers["beauty"]).max(-1) > 0)
    assert near_focus.sum() < 0.5 * in_focus.sum()


def test_directions_in_the_picture_are_those_of_the_scene() -> None:
    """+X right, +Y up, the near box in front of the far one."""
    colours = {"right": (1, 0, 0), "up": (0, 1, 0), "far": (0, 0, 1), "near": (1, 1, 0)}
    places = {"right": (2, 0, 0), "up": (0, 2, 0), "far": (0, 0, -3), "near": (0.2, 0, 2)}
    materials = [
        Material(name=n, base_colour=(*map(float, c), 1.0), unlit=True) for n, c in colours.items()
    ]
    parts = [
        Part(box(0.8, 0.8, 0.8).moved([x, y - 0.4, z]), number)
        for number, (x, y, z) in enumerate(places.values())
    ]
    scene = scene_of("boxes", parts, materials)
    view = {"eye": [0, 0, 8], "target": [0, 0, 0], "width": 64, "height": 64, "fov_y_deg": 50}
    beauty = raysvc.render(scene, constant_environment(0.0), view, PLAIN).layers["beauty"]
    rows, cols = np.nonzero(beauty[..., :3].any(axis=-1))
    middle = lambda c: np.argwhere((beauty[..., :3] == c).all(axis=-1)).mean(axis=0)  # noqa: E731
    assert middle((1, 0, 0))[1] > 40 and abs(middle((1, 0, 0))[0] - 31.5) < 2
    assert middle((0, 1, 0))[0] < 24 and abs(middle((0, 1, 0))[1] - 31.5) < 2
    assert tuple(beauty[32, 32, :3]) == (1, 1, 0)
    assert len(rows) == len(cols)


def test_the_environment_is_seen_where_its_conventions_say() -> None:
    """Centre column along -Z, +X to its right, row 0 up; yaw turns it counter-clockwise from
    above."""
    radiance = np.zeros((32, 64, 3), np.float32)
    radiance[14:18, 30:34] = (1, 0, 0)  # along -Z
    radiance[14:18, 46:50] = (0, 1, 0)  # along +X
    radiance[:3] = (0, 0, 1)  # up
    environment = Environment(radiance)
    scene = scene_of("far away", [Part(sphere(0.01, 4).moved([0, -50, 0]), 0)], [GREY])

    def seen(target: list[float], yaw_deg: float = 0.0) -> tuple[float, ...]:
        view = {"eye": [0, 0, 0], "target": target, "up": [0, 0.9, 0.1], "width": 9, "height": 9}
        settings = PLAIN | {"environment_yaw_deg": yaw_deg}
        frame = raysvc.render(scene, environment, view | {"fov_y_deg": 5}, settings)
        return tuple(frame.layers["beauty"][4, 4, :3].round(3).tolist())

    assert seen([0, 0, -1]) == (1, 0, 0)
    assert seen([1, 0, 0]) == (0, 1, 0)
    assert seen([0, 1, 0]) == (0, 0, 1)
    # Turned a quarter counter-clockwise seen from above, what was at -Z is at -X, what was at +X
    # at -Z. sert seen([-1, 0, 0], yaw_deg=90) == (1, 0, 0)
    assert seen([0, 0, -1], yaw_deg=90) == (0, 1, 0)


def test_a_mirror_shows_the_environment_behind_the_camera() -> None:
    radiance = np.full((32, 64, 3), 0.1, np.float32)
    radiance[:, [*range(4), *range(60, 64)]] = (0, 1, 0)  # along +Z
    mirror = Material(metallic=1.0, roughness=0.0)
    frame = raysvc.render(ball(mirror, 96), Environment(radiance), FRONT, {"aa": "none"})
    centre = frame.layers["beauty"][23:25, 23:25, :3].mean(axis=(0, 1))
    np.testing.assert_allclose(centre, (0, 1, 0), atol=0.02)


def test_a_punctual_light_casts_a_shadow_with_the_right_edge() -> None:
    floor = Part(sheet(10, 10, 1, 1), 0)
    lid = Part(sheet(2, 2, 1, 1).moved([0, 1, 0]), 0)
    grey = Material(base_colour=(0.5, 0.5, 0.5, 1), metallic=0.0, double_sided=True)
    light = PunctualLight("directional", (1.0, 1.0, 1.0), direction=(0.0, -1.0, 0.0))
    scene = scene_of("lid", [floor, lid], [grey], lights=[light])
    view = {"eye": [6, 0.9, 0], "target": [0, 0, 0], "width": 64, "height": 32, "fov_y_deg": 50}
    frame = raysvc.render(scene, constant_environment(0.0), view, PLAIN)
    lit = frame.layers["beauty"][..., 0] > 0
    on_floor = (frame.layers["object"] == 0) & np.isfinite(frame.layers["depth"])
    camera = raysvc.frame.view.camera_from(raysvc.View(**view), scene)
    pixels = np.flatnonzero(on_floor.reshape(-1))
    origins, directions = camera.rays(pixels)
    at = origins - directions * (origins[:, 1] / directions[:, 1])[:, None]
    shaded = np.maximum(np.abs(at[:, 0]), np.abs(at[:, 2])) < 1
    clear = np.abs(np.maximum(np.abs(at[:, 0]), np.abs(at[:, 2])) - 1) > 1e-3
    assert np.array_equal(~lit[on_floor][clear], shaded[clear])
    assert shaded.any()


def test_blended_layers_are_put_over_one_another() -> None:
    panes = [
        Material(base_colour=(1, 0, 0, 0.5), alpha_mode="blend", unlit=True),
        Material(base_colour=(0, 1, 0, 0.25), alpha_mode="blend", unlit=True),
        Material(base_colour=(0, 0, 1, 1), unlit=True),
    ]
    parts = [
        Part(sheet(4, 4, 1, 1).turned(90, 0).moved([0, 0, z]), number)
        for number, z in enumerate((1.0, 0.0, -1.0))
    ]
    scene = scene_of("panes", parts, panes)
    for aa in ("none", "full"):
        settings = {"aa": aa, "background": "transparent"}
        frame = raysvc.render(scene, None, FRONT | {"width": 8, "height": 8}, settings)
        expected = (0.5, 0.5 * 0.25, 0.5 * 0.75, 1.0)
        np.testing.assert_allclose(frame.layers["beauty"][4, 4], expected, atol=1e-6)
        only_front = scene_of("pane", parts[:1], panes[:1])
        frame = raysvc.render(only_front, None, FRONT | {"width": 8, "height": 8}, settings)
        np.testing.assert_allclose(frame.layers["beauty"][4, 4], (0.5, 0, 0, 0.5), atol=1e-6)


@pytest.mark.parametrize("background", ["environment", "transparent", [0.25, 0.5, 0.75]])
def test_the_background_is_what_was_asked_for(background: object) -> None:
    frame = raysvc.render(
        ball(GREY), constant_environment(2.0), FRONT, {"background": background, "aa": "none"}
    )
    corner = frame.layers["beauty"][0, 0]
    expected = {
        "environment": (2, 2, 2, 1),
        "transparent": (0, 0, 0, 0),
    }.get(str(background), (0.25, 0.5, 0.75, 1))
    np.testing.assert_allclose(corner, expected, rtol=1e-6)
    assert frame.layers["beauty"][24, 24, 3] == 1.0


def test_layers_say_what_a_pixel_shows() -> None:
    frame = raysvc.render(ball(GREY, 96), None, FRONT, {"aa": "none"})
    layers = frame.layers
    seen = layers["id"] >= 0
    assert layers["beauty"].shape == (48, 48, 4)
    assert np.array_equal(np.isfinite(layers["depth"]), seen)
    assert not layers["normal"][~seen].any()
    assert layers["depth"][24, 24] == pytest.approx(3.0, abs=0.01)
    np.testing.assert_allclose(layers["normal"][24, 24], (0, 0, 1), atol=0.05)
    np.testing.assert_allclose(np.linalg.norm(layers["normal"][seen], axis=1), 1, atol=1e-5)
    np.testing.assert_allclose(layers["albedo"][seen], 0.5)
    assert set(np.unique(layers["object"])) == set(np.unique(layers["material"])) == {-1, 0}


def test_statistics_have_every_field_of_the_specification() -> None:
    statistics = raysvc.render(still_life(), camera=VIEW).statistics.to_dict()
    assert set(statistics) == {
        "width",
        "height",
        "triangles",
        "structure",
        "threads",
        "stages",
        "total_seconds",
        "rays",
        "bounces",
        "shading",
        "build",
        "environment",
        "probe",
        "edge_fraction",
        "max_coc_px",
        "warnings",
        "renderer_version",
    }
    names = [stage["name"] for stage in statistics["stages"]]
    assert names[:2] == ["prepare", "rasterise"] and names[-1] == "lens"
    assert {"shadow", "occlusion", "reflection", "primary"} <= set(statistics["rays"])
    environment = statistics["environment"]
    assert (environment["ibl"], environment["order"], environment["builder"]) == ("sat", 2, "fused")
    assert environment["suns"] == 1 and environment["seconds"] >= 0
    assert 0 < statistics["edge_fraction"] < 0.5


def test_a_second_frame_finds_what_the_first_has_prepared() -> None:
    scene = still_life()
    first = raysvc.render(scene, camera=VIEW, settings={"aa": "none"})
    second = raysvc.render(scene, camera=VIEW, settings={"aa": "none"})
    assert not first.statistics.build["cached"]
    assert second.statistics.build["cached"]
    assert first.encode("exr") == second.encode("exr")


def test_edge_samples_lie_between_no_and_full_anti_aliasing() -> None:
    scene = still_life()
    frames = {
        name: raysvc.render(scene, camera=VIEW, settings={"aa": name, "aa_samples": 16})
        for name in ("none", "edges", "full")
    }
    aa = {name: frame.layers["beauty"] for name, frame in frames.items()}
    flagged = frames["edges"].layers["edge"] > 0
    error = {name: np.abs(aa[name] - aa["full"])[flagged].mean() for name in ("none", "edges")}
    assert 0.02 < flagged.mean() < 0.3
    assert error["edges"] < 0.7 * error["none"]
    # About grain in glossy surfaces `none` has asked more rays: what remains is the background.
    kept = ~flagged & (frames["none"].layers["object"] < 0)
    assert np.array_equal(aa["edges"][kept], aa["none"][kept])


def test_edge_samples_find_the_coverage_of_even_surfaces_exactly() -> None:
    white = Material(unlit=True, double_sided=True)
    tilted = sheet(1.3, 0.9, 1, 1).turned(90, 0).turned(17, 2)
    scene = scene_of("card", [Part(tilted, 0)], [white])
    edges, full = (
        raysvc.render(scene, None, FRONT, {"aa": aa, "aa_samples": 16, "background": [0, 0, 0]})
        for aa in ("edges", "full")
    )
    # A corner may lie in a pixel that shows nothing at its own centre nor at its neighbours'.
    assert (edges.layers["beauty"] != full.layers["beauty"]).any(axis=-1).sum() <= 8
    coverage = full.layers["beauty"][..., 0]
    assert len(np.unique(coverage)) > 8
    # Half the width of the picture is 4 tan(20 deg) metres, 24 pixels.
    area_px = 1.3 * 0.9 * (24 / (4 * np.tan(np.radians(20)))) ** 2
    assert coverage.sum() == pytest.approx(area_px, rel=0.01)


def test_a_cancelled_frame_stops() -> None:
    control = Control()
    reached = threading.Event()

    def progress(stage: str, fraction: float) -> None:
        if stage == "occlusion":
            reached.set()
            control.cancel()

    control = Control(threads=2, on_progress=progress)
    with pytest.raises(Cancelled):
        raysvc.render(still_life(), camera=VIEW | {"width": 640, "height": 360}, control=control)
    assert reached.is_set()


def test_a_frame_that_is_cancelled_at_its_beginning_builds_no_trees(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def progress(stage: str, fraction: float) -> None:
        control.cancel()

    control = Control(on_progress=progress)
    monkeypatch.setattr("raysvc.frame.prepared.fit_of", lambda *_: pytest.fail("trees were built"))
    with pytest.raises(Cancelled):
        raysvc.render(still_life(), camera=VIEW, control=control)


def test_a_deadline_ends_a_frame() -> None:
    with pytest.raises(DeadlineExceeded) as caught:
        raysvc.render(still_life(), camera=VIEW, settings={"deadline_s": 1e-6})
    assert caught.value.field == "deadline_s"


def test_an_empty_scene_is_all_background() -> None:
    empty = scene_of("empty", [Part(sheet(1, 1, 1, 1), 0)], [GREY])
    empty = raysvc.Scene(
        **{
            name: getattr(empty, name)
            for name in ("positions", "normals", "tangents", "uv", "colours", "materials")
        },
        triangles=np.zeros((0, 3), np.int32),
        material_of_triangle=np.zeros(0, np.int32),
        object_of_triangle=np.zeros(0, np.int32),
    )
    frame = raysvc.render(empty, constant_environment(), {"width": 8, "height": 4})
    np.testing.assert_allclose(frame.layers["beauty"], 1.0)


@pytest.mark.parametrize("format", ["png", "png16", "jpg", "webp", "exr", "npz"])
def test_a_frame_is_encoded_in_every_format(format: str, tmp_path) -> None:
    frame = raysvc.render(ball(GREY, 8), None, {"width": 16, "height": 9}, PLAIN)
    if format != "png16":
        frame.save(tmp_path / f"picture.{format}")
        assert (tmp_path / f"picture.{format}").read_bytes() == frame.encode(format)
    assert len(frame.encode(format)) > 100


def test_unknown_formats_and_layers_are_refused_by_name(tmp_path) -> None:
    frame = raysvc.render(ball(GREY, 8), None, {"width": 16, "height": 9}, PLAIN)
    with pytest.raises(InvalidSetting, match="gif"):
        frame.save(tmp_path / "picture.gif")
    with pytest.raises(InvalidSetting, match="heat"):
        frame.encode("png", "heat")
    with pytest.raises(InvalidSetting, match="16 bits"):
        frame.encode("png16", "normal")
