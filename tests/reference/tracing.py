"""Asking a path tracer for the light along rays."""

import numpy as np

from raysvc.parallel import Control
from raysvc.reference.emitters import Emitters
from raysvc.reference.environment import EnvironmentLight
from raysvc.reference.paths import Draws, Lights, PathTracer
from raysvc.scene import Environment
from raysvc.shading.scene_tables import SceneTables
from raysvc.tracing.world import World
from tests.scenes import rays

BLACK = Environment(np.zeros((2, 4, 3), np.float32), name="black")


def grey_sky(value=1.0):
    return Environment(np.full((4, 8, 3), value, np.float32), name="grey")


def tracer(scene, environment=BLACK, bounces=0, structure="auto"):
    tables = SceneTables.of(scene)
    lights = Lights(EnvironmentLight(environment), Emitters(scene, tables), scene.lights)
    counted = {}

    def count(kind, number):
        counted[kind] = counted.get(kind, 0) + number

    made = PathTracer(World(scene, tables, structure), tables, lights, bounces, count)
    return made, counted


def light_along(scene, origin, direction, samples, environment=BLACK, bounces=0, key=1):
    """Mean radiance (3,) float64 of many paths along one ray, and how many of them met anything."""
    direction = np.asarray(direction, float) / np.linalg.norm(direction)
    asked = rays(origin, np.tile(direction, (samples, 1)))
    draws = Draws(np.full(samples, key, np.uint32), np.arange(samples, dtype=np.uint32))
    radiance, met = tracer(scene, environment, bounces)[0].trace(asked, draws, Control(threads=1))
    return radiance.mean(axis=0, dtype=float), met.mean()
