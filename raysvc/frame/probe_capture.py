"""Capturing what is around a point of the scene, with the stages of a frame itself.

Six pictures of the faces of a cube are rasterised, shadowed and lit as a frame's points are, but
without reflected rays: what glossy surfaces around would mirror of the scene is taken to be the
mean of what hides the environment there. Nothing in them is a light that the frame's points look
for themselves: the sun's disc is not behind the scene, and lamps, which smooth surfaces are to
show, are captured apart.

Faces share no slots, and each is made by one thread: bytes do not depend on how many there are.
"""

import dataclasses
import time
from typing import Final

import numpy as np

from raysvc.frame.composite_kernels import over
from raysvc.frame.draft import Draft
from raysvc.frame.kept import Kept
from raysvc.frame.probe import Probe
from raysvc.frame.probe_light import WITHOUT_SUN_RAD, Captured, ProbeLight
from raysvc.frame.radiance import glossiness
from raysvc.frame.reflections import Reflection, Transmission
from raysvc.frame.secondary_rays import SecondaryRays
from raysvc.frame.settings import Settings
from raysvc.frame.shared_rays import trace_beyond
from raysvc.frame.stages import gather_ambient, light, rasterise, shadows, write_layers
from raysvc.frame.statistics import ProbeCost
from raysvc.lighting.ambient import Ambient
from raysvc.lighting.brushed_light import round_roughness
from raysvc.lighting.cube_map import face_cameras, lat_long_of_faces, pixel_half_width_rad
from raysvc.lighting.image_light import ImageLight
from raysvc.parallel import for_chunks
from raysvc.scene import Camera, Environment, Scene
from raysvc.types import Bools, Floats

MARGIN = 1.001
FREE_OF_RAYS: Final = {"bounces": 0, "aa": "none", "lens": "none", "background": "transparent"}
"""How the faces differ from the frame."""


_CAPTURED: Kept[Environment, Kept[Scene, Captured]] = Kept()


INDIFFERENT: Final = {
    "mode",
    "samples",
    "passes",
    "lens_samples",
    "lens_shape",
    "lens_order",
    "lens_layers",
    "aperture_blades",
    "aperture_rotation_deg",
    "aa_samples",
    "exposure_stops",
    "tone_map",
    "threads",
    "deadline_s",
}
"""Settings that what is captured does not depend on. A probe is kept while all others are the same:
one that is forgotten here costs a capture, and never shows an old one."""


def probe(draft: Draft) -> None:
    """Let glossy points show what is captured from the frame's probe, if it has one.

    It is kept as long as scene and environment live, and everything else that it depends on is the
    same. A deformed scene is another scene.
    """
    if draft.probe is None:
        return
    asked, settings = draft.probe, draft.settings.model_copy(update=FREE_OF_RAYS)
    decisive = settings.model_dump(exclude=INDIFFERENT)
    scenes, _ = _CAPTURED.get(draft.environment, None, Kept)
    captured, had = scenes.get(
        draft.prepared.scene,
        (asked, *decisive.items()),
        lambda: _capture(draft, asked, settings),
    )
    draft.ledger.probe = ProbeCost(
        at=asked.probe_at,
        size=asked.size,
        left_out=captured.left_out,
        rebuilt=not had,
        capture_seconds=0.0 if had else captured.capture_seconds,
        tables_seconds=0.0 if had else captured.tables_seconds,
    )
    draft.rays.show(ProbeLight(captured, draft.prepared, draft.ledger))


def _capture(draft: Draft, probe: Probe, settings: Settings) -> Captured:
    prepared, control = draft.prepared, draft.control
    start = time.perf_counter()
    shown = probe.shown(prepared.scene)
    cameras = face_cameras(np.array(probe.probe_at, np.float64), probe.size)
    side = cameras[0].width
    around, lamps = np.empty((2, len(cameras), side, side, 3), np.float32)
    rays = SecondaryRays(
        prepared,
        settings,
        draft.illumination,
        draft.ledger,
        narrowest_rad=WITHOUT_SUN_RAD,
    )
    serial = control.limited(1, None).quiet()

    def face(begin: int, end: int) -> None:
        for number in range(begin, end):
            picture = Draft(
                prepared,
                cameras[number],
                settings,
                serial,
                draft.ledger,
                draft.illumination,
                rays,
                draft.environment,
                shown=shown & before(cameras[number], prepared.scene),
            )
            around[number], lamps[number] = _seen(picture, probe.size)

    for_chunks(len(cameras), 1, face, control, "probe")
    map_ = lat_long_of_faces(around, control)
    lamp_map = lat_long_of_faces(lamps, control) if lamps.any() else None
    control.check()
    between = time.perf_counter()

    def filtered(radiance: Floats) -> ImageLight:
        filtering = prepared.light.filtering
        return ImageLight(Environment(radiance), filtering=filtering, control=control)

    return Captured(
        filtered(map_),
        None if lamp_map is None else filtered(lamp_map),
        int(np.count_nonzero(~shown)),
        between - start,
        time.perf_counter() - between,
    )


def _seen(draft: Draft, size: int) -> tuple[Floats, Floats]:
    """(H, W, 3) radiance of one face without lamps, and that of lamps alone."""
    rasterise(draft)
    lamps = _put_out_lamps(draft)
    write_layers(draft)
    shadows(draft)
    gather_ambient(draft)
    if draft.prepared.tables.glassy:
        trace_beyond(draft)
    else:
        draft.transmission = Transmission.none(len(draft.points.pixel))
    draft.reflection = _mirrored_on_the_mean(draft)
    light(draft)
    rgba = draft.beauty.reshape(-1, 4)
    open_ = np.flatnonzero(rgba[:, 3] < 1.0)
    rgba[open_, :3] += (1.0 - rgba[open_, 3:]) * _behind(draft.prepared.light, draft.camera, open_)
    return np.maximum(rgba[:, :3], 0.0).reshape(*draft.shape, 3), lamps


def before(camera: Camera, scene: Scene) -> Bools:
    """(F,) triangles that may be in a perspective camera's view: not beyond one of its sides.

    Five of six faces need not look at a triangle any closer.
    """
    right, up = camera.world_from_camera[:3, 0], camera.world_from_camera[:3, 1]
    x, y, depth = np.stack([right, up, camera.forward]) @ (scene.positions - camera.eye).T
    # Rounding must not lose what touches a side
    reach_y = camera.half_height * MARGIN * depth
    reach_x = reach_y * (camera.width / camera.height)
    beyond = np.zeros(len(x), np.uint8)
    for side, is_out in enumerate((x > reach_x, -x > reach_x, y > reach_y, -y > reach_y)):
        beyond |= is_out.astype(np.uint8) << np.uint8(side)
    corners = beyond[scene.triangles]
    found: Bools = (corners[:, 0] & corners[:, 1] & corners[:, 2]) == 0
    return found


def _put_out_lamps(draft: Draft) -> Floats:
    """Take the emission of lamps from the points; returns it as a picture (H, W, 3)."""
    points = draft.points
    rgba = np.zeros((draft.camera.height * draft.camera.width, 4), np.float32)
    shines = draft.prepared.lamps.shines[points.triangle]
    if shines.any():
        surface = points.surface
        glow = np.where(shines[:, None], surface.emissive, np.float32(0.0))
        over(points.pixel, glow, surface.alpha, rgba)
        dark = surface._replace(emissive=surface.emissive - glow)
        draft.points = dataclasses.replace(points, surface=dark)
    return rgba[:, :3].reshape(*draft.shape, 3)


def _mirrored_on_the_mean(draft: Draft) -> Reflection:
    """What glossy points mirror of the scene when no rays tell: as matt ones do."""
    around = Ambient.of_columns(draft.ambient)
    hidden = np.clip(1.0 - around.sky.mean(axis=1), 0.0, 1.0)
    gloss = glossiness(round_roughness(draft.points.surface))
    occlusion = draft.points.surface.occlusion[:, None]
    radiance = around.bounced * occlusion / np.maximum(hidden, np.float32(1e-3))[:, None]
    none = Reflection.none(len(hidden))
    return none._replace(radiance=radiance, share=gloss * hidden)


def _behind(light: ImageLight, camera: Camera, pixel: np.ndarray) -> Floats:
    """(P, 3) mean radiance over pixels of the environment without its sun."""
    _, directions = camera.rays(pixel)
    size = round(camera.height / camera.half_height)
    width = max(pixel_half_width_rad(size), WITHOUT_SUN_RAD)
    return light.cone(directions, np.full(len(directions), width, np.float32))
