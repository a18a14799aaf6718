"""Compile every kernel that a frame may need, or load it from the cache."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np

from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import sheet, sphere
from raysvc.frame.refocus import refocus
from raysvc.frame.render import render
from raysvc.frame.view import View
from raysvc.lighting.albedo import albedo_tables
from raysvc.lighting.boundary_albedo import boundary_tables
from raysvc.parallel import Control
from raysvc.scene import Environment, Material, PunctualLight, Scene, Texture, TextureRef

VIEW = View(eye=(0.0, 0.4, 3.0), target=(0.0, 0.0, 0.0), width=32, height=18, aperture_radius=0.05)


QUICK = {"aa_samples": 1}
"""Settings that need the same kernels as the usual ones, and less time."""


def warm_up(control: Control | None = None) -> None:
    """Render small pictures that go through every stage and every kind of material.

    And move a vertex, which is done before a frame, and blur by more than those pictures are.
    """
    scene, sky = specimen(), _sky()
    with ThreadPoolExecutor(1, thread_name_prefix="raysvc") as aside:
        # Integrating these leaves the interpreter free to load kernels meanwhile.
        tables = [aside.submit(make) for make in (albedo_tables, boundary_tables)]
        once = {**QUICK, "bounces": 1}
        render(scene, sky, VIEW, {"texture_filter": "sat", **once}, control=control)
        probe = {"probe_at": (0.0, 0.0, 0.0), "size": 16, "environment": sky}
        render(scene, probe, VIEW, QUICK, control=control)
        render(scene, sky, VIEW, {"mode": "reference", "samples": 1}, control=control)
        for each in tables:
            each.result()
    scene.deformed(scene.positions)
    _warm_up_lens(control)


def _sky() -> Environment:
    """Grey, with a sun: what filtering tells apart, in few texels."""
    radiance = np.full((16, 32, 3), 0.5, np.float32)
    radiance[4, 8] = 20_000.0
    return Environment(radiance)


def _warm_up_lens(control: Control | None) -> None:
    """Blur a small picture by circles small and large, through every bokeh."""
    rgba = np.ones((48, 64, 4), np.float32)
    depth = np.geomspace(0.05, 50.0, 64, dtype=np.float32) * np.ones((48, 1), np.float32)
    depth[:, 20:30] = 0.02
    lens = {"aperture_radius": 0.5, "focus_distance": 1.0}
    for bokeh in ({}, {"lens_shape": "box"}, {"lens_order": 2}, {"lens": "gather"}):
        refocus(rgba, depth.astype(np.float32), lens, bokeh, control=control)


def specimen() -> Scene:
    """A shining, varnished glass ball with all textures, two panes before it, and a lamp."""
    texels = np.full((4, 4, 4), 200, np.uint8)
    texels[::2, ::2, 3] = 0
    ref = TextureRef(0)
    textured = Material(
        name="textured",
        base_colour_texture=ref,
        metallic_roughness_texture=ref,
        normal_texture=ref,
        occlusion_texture=ref,
        emissive_texture=ref,
        transmission_texture=ref,
        clearcoat_texture=ref,
        clearcoat_roughness_texture=ref,
        clearcoat_normal_texture=ref,
        anisotropy_texture=ref,
        emissive=(1.0, 1.0, 1.0),
        roughness=0.3,
        transmission=0.5,
        solid=True,
        clearcoat=1.0,
        clearcoat_roughness=0.2,
        anisotropy=0.7,
    )
    panes = [
        Material(name=mode, alpha_mode=mode, base_colour_texture=ref, double_sided=True)
        for mode in ("mask", "blend")
    ]
    parts = [
        Part(sphere(0.8, 8), 0),
        Part(sheet(1.0, 1.0, 1, 1).turned(90, 0).moved([-0.6, 0.0, 1.0]), 1),
        Part(sheet(1.0, 1.0, 1, 1).turned(90, 0).moved([0.6, 0.0, 1.0]), 2),
    ]
    lamp = PunctualLight("point", (3.0, 3.0, 3.0), position=(1.0, 2.0, 2.0))
    return scene_of(
        "specimen", parts, [textured, *panes], textures=[Texture(texels)], lights=[lamp]
    )
