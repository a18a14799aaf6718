"""How long it takes to filter a map, and to light a whole picture by it."""

import statistics
import time
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from raysvc.builtin import BUILTIN_SCENES
from raysvc.compare.measure import Steps
from raysvc.frame.prepared import prepare
from raysvc.frame.primary import points_of, rasterised
from raysvc.frame.radiance import specular_lobe
from raysvc.frame.settings import Settings
from raysvc.frame.view import View, camera_from
from raysvc.lighting.area_resampling import resampled
from raysvc.lighting.image_light import Filtering, ImageLight
from raysvc.parallel import Control, for_chunks
from raysvc.scene import Camera, Environment
from raysvc.shading.surface import Surface
from raysvc.types import Floats, Longs

SCENE: Final = "torus_park"
WIDTH, HEIGHT = 1280, 720
CHUNK = 1 << 15
MAP_ROWS: Final = 256
"""Of the map, as large as a probe's: that is what changes with every frame."""


@dataclass(frozen=True, slots=True)
class LightSpeed:
    """Lighting all that a picture of the built-in park shows, diffuse and specular lobes."""

    measured: Literal["light"]
    scene: str
    order: int
    lookups: int
    threads: int
    map_width: int
    map_height: int
    width: int
    height: int
    points: int
    """Of surfaces; the other pixels look the map up."""
    tables_seconds: float
    """Median of filtering the map."""
    static_seconds: float
    """Median of lighting, the map filtered before."""
    rebuilt_seconds: float
    """Median of both together, as when the environment changes with every frame."""


class LitPicture:
    """The surfaces and the background of a picture."""

    def __init__(self, environment: Environment, control: Control) -> None:
        scene = BUILTIN_SCENES[SCENE]()
        settings = Settings(occlusion_samples=0, texture_filter="mip")
        prepared = prepare(scene, environment, settings)
        camera: Camera = camera_from(View(width=WIDTH, height=HEIGHT), scene)
        pixel, triangle = rasterised(prepared, camera, control)
        found = points_of(prepared, camera, pixel, triangle, settings.texture_filter, control)
        self.surface: Surface = found.surface
        open_: Longs = np.setdiff1d(np.arange(WIDTH * HEIGHT), pixel)
        self.background: Floats = camera.rays(open_)[1]

    def light(self, light: ImageLight, control: Control) -> None:
        """Light everything."""
        surface, shown = self.surface, np.empty((self.surface.size, 3), np.float32)

        def work(begin: int, end: int) -> None:
            some = surface.rows(begin, end)
            lobe = specular_lobe(light, some, light.specular_albedo(some))
            shown[begin:end] = lobe + light.diffuse(some)

        for_chunks(surface.size, CHUNK, work, control)

        def look_up(begin: int, end: int) -> None:
            light.radiance(self.background[begin:end])

        for_chunks(len(self.background), CHUNK, look_up, control)


def light_speed(
    environment: Environment,
    picture: LitPicture,
    order: int,
    rounds: int,
    steps: Steps,
    control: Control,
) -> LightSpeed:
    """Measure with `control`'s threads; each of rounds + 1 is one of `steps`."""
    map_ = Environment(resampled(environment.radiance, MAP_ROWS, 2 * MAP_ROWS).astype(np.float32))
    filtering = Filtering(order=order)
    tables, lit = [], []
    for number in range(rounds + 1):
        steps.next(f"light, order {order}, {control.threads} threads")
        begin = time.perf_counter()
        light = ImageLight(map_, filtering=filtering, control=control)
        between = time.perf_counter()
        picture.light(light, control)
        if number:
            tables.append(between - begin)
            lit.append(time.perf_counter() - between)
    return LightSpeed(
        measured="light",
        scene=f"builtin:{SCENE}",
        order=order,
        lookups=filtering.lookups,
        threads=control.threads,
        map_width=map_.radiance.shape[1],
        map_height=map_.radiance.shape[0],
        width=WIDTH,
        height=HEIGHT,
        points=picture.surface.size,
        tables_seconds=statistics.median(tables),
        static_seconds=statistics.median(lit),
        rebuilt_seconds=statistics.median(a + b for a, b in zip(tables, lit, strict=True)),
    )
