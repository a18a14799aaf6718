"""What is made once for a scene or environment and serves many frames."""

import threading
import time
import weakref
from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

from raysvc.frame.settings import Settings
from raysvc.lighting.image_light import ImageLight
from raysvc.reference.emitters import Emitters
from raysvc.reference.environment import EnvironmentLight
from raysvc.reference.paths import Lights
from raysvc.scene import Environment, Scene
from raysvc.shading.scene_tables import SceneTables
from raysvc.tracing.world import World

Owner = TypeVar("Owner")
Made = TypeVar("Made")


class _Kept(Generic[Owner, Made]):
    """Things made from an owner and a key, kept as long as the owner lives; the last few keys of
    each."""

    KEYS = 4

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._made: weakref.WeakKeyDictionary[Owner, dict[object, Made]] = (
            weakref.WeakKeyDictionary()
        )

    def get(self, owner: Owner, key: object, make: Callable[[], Made]) -> tuple[Made, bool]:
        """Return what was made earlier and True, or make it."""
        with self._lock:
            made = self._made.get(owner, {})
            if key in made:
                made[key] = made.pop(key)  # most recently used last
                return made[key], True
        thing = make()
        with self._lock:
            made = self._made.setdefault(owner, {})
            made[key] = thing
            while len(made) > self.KEYS:
                del made[next(iter(made))]
        return thing, False


_TABLES: _Kept[Scene, SceneTables] = _Kept()
_WORLDS: _Kept[Scene, World] = _Kept()
_LIGHTS: _Kept[Environment, ImageLight] = _Kept()
_SKIES: _Kept[Environment, EnvironmentLight] = _Kept()
_EMITTERS: _Kept[Scene, Emitters] = _Kept()


@dataclass(frozen=True, slots=True)
class Prepared:
    """Everything that a frame reads and no frame changes."""

    scene: Scene
    tables: SceneTables
    world: World
    light: ImageLight
    path_lights: Lights | None
    """What paths look for; only in reference mode."""
    seconds: float
    """What making it took."""
    cached: bool
    """Nothing had to be made."""


def prepare(scene: Scene, environment: Environment, settings: Settings) -> Prepared:
    """Make, or find again, the tables and structures of a scene and the filters of an
    environment."""
    start = time.perf_counter()
    structure, trees = settings.structure, settings.trees
    turned = settings.environment_yaw_deg, settings.environment_strength
    tables, had_tables = _TABLES.get(scene, None, lambda: SceneTables.of(scene))
    world, had_world = _WORLDS.get(
        scene, (structure, trees), lambda: World(scene, tables, structure, trees)
    )
    light, had_light = _LIGHTS.get(environment, turned, lambda: ImageLight(environment, *turned))
    cached = had_tables and had_world and had_light
    path_lights = None
    if settings.mode == "reference":
        sky, had_sky = _SKIES.get(
            environment, turned, lambda: EnvironmentLight(environment, *turned)
        )
        emitters, had_emitters = _EMITTERS.get(scene, None, lambda: Emitters(scene, tables))
        path_lights = Lights(sky, emitters, scene.lights)
        cached = cached and had_sky and had_emitters
    seconds = time.perf_counter() - start
    return Prepared(scene, tables, world, light, path_lights, seconds, cached)
