"""Tables and structures of scenes and of their deformed shapes, made from one another.

They are kept for a scene as it was made while it lives; of all its shapes together, whichever was
last asked for is kept while any of them lives. So an animation always finds trees to move, and does
not gather those of its frames.
"""

from typing import Literal

from raysvc.frame.kept import Kept
from raysvc.scene import Scene
from raysvc.scene.rest_shape import RestShape
from raysvc.shading.scene_tables import SceneTables
from raysvc.tracing.fitting import Fit, fitted

_TABLES: Kept[Scene, SceneTables] = Kept()
_FITS: Kept[Scene, Fit] = Kept()
_LATEST_TABLES: Kept[RestShape, SceneTables] = Kept()
_LATEST_FITS: Kept[RestShape, Fit] = Kept()


def tables_of(scene: Scene) -> tuple[SceneTables, bool]:
    """Tables of a scene, which share with those of its other shapes what they can; and whether they
    were there."""
    tables = _TABLES.find(scene, None)
    had = tables is not None
    if tables is None:
        kin = _LATEST_TABLES.find(scene.rest, None)
        tables = SceneTables.of(scene) if kin is None else kin.of_shape(scene)
        _TABLES.keep(scene, None, tables)
    _LATEST_TABLES.keep(scene.rest, None, tables)
    return tables, had


def fit_of(
    scene: Scene, tables: SceneTables, structure: str, trees: Literal["one", "per_material"]
) -> tuple[Fit, bool]:
    """Trees around a scene, and whether they were there."""
    key = (structure, trees)
    latest = _LATEST_FITS.find(scene.rest, key)
    fit = _FITS.find(scene, key)
    if fit is None and latest is not None and latest.world.is_around(scene):
        fit = latest
    had = fit is not None
    if fit is None:
        kin = None if latest is None else latest.world
        fit = fitted(scene, tables, structure, trees, kin)
        if not scene.is_deformed:
            _FITS.keep(scene, key, fit)
    _LATEST_FITS.keep(scene.rest, key, fit)
    return fit, had
