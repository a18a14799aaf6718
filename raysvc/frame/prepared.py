"""What is made once for a scene or environment and serves many frames."""

import threading
import time
import weakref
from dataclasses import dataclass
from typing import Generic, TypeVar

from raysvc.frame.settings import Settings
from raysvc.lighting.image_light import ImageLight
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

    def find(self, owner: Owner, key: object) -> Made | None:
        with self._lock:
            made = self._made.get(owner, {})
            if key in made:
                made[key] = made.pop(key)  # most recently used last
            return made.get(key)

    def keep(self, owner: Owner, key: object, thing: Made) -> None:
        with self._lock:
            made = self._made.setdefault(owner, {})
            made[key] = thing
            while len(made) > self.KEYS:
                del made[next(iter(made))]


_TABLES: _Kept[Scene, SceneTables] = _Kept()
_WORLDS: _Kept[Scene, World] = _Kept()
_LIGHTS: _Kept[Environment, ImageLight] = _Kept()


@dataclass(frozen=True, slots=True)
class Prepared:
    """Everything that a frame reads and no frame changes."""

    scene: Scene
    tables: SceneTables
    world: World
    light: ImageLight
    seconds: float
    """What making it took."""
    cached: bool
    """Nothing had to be made."""


def prepare(scene: Scene, environment: Environment, settings: Settings) -> Prepared:
    """Make, or find again, the tables and structures of a scene and the filters of an
    environment."""
    start = time.perf_counter()
    structure, trees = settings.structure, settings.trees
    yaw_deg, strength = settings.environment_yaw_deg, settings.environment_strength
    tables = _TABLES.find(scene, None)
    world = _WORLDS.find(scene, (structure, trees))
    light = _LIGHTS.find(environment, (yaw_deg, strength))
    cached = tables is not None and world is not None and light is not None
    if tables is None:
        tables = SceneTables.of(scene)
        _TABLES.keep(scene, None, tables)
    if world is None:
        world = World(scene, tables, structure, trees)
        _WORLDS.keep(scene, (structure, trees), world)
    if light is None:
        light = ImageLight(environment, yaw_deg, strength)
        _LIGHTS.keep(environment, (yaw_deg, strength), light)
    return Prepared(scene, tables, world, light, time.perf_counter() - start, cached)
