"""Scene, environment, camera, settings in; frame out."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from raysvc.frame.draft import Draft
from raysvc.frame.focus import focused
from raysvc.frame.frame import Frame
from raysvc.frame.order import STAGES
from raysvc.frame.prepared import prepare
from raysvc.frame.probe import check_probe
from raysvc.frame.radiance import Illumination
from raysvc.frame.secondary_rays import SecondaryRays
from raysvc.frame.settings import Settings, check_cost, checked, settings_from
from raysvc.frame.statistics import Ledger, Statistics
from raysvc.frame.surroundings import surroundings
from raysvc.frame.view import View, camera_from
from raysvc.limits import DEFAULT_LIMITS, Limits
from raysvc.parallel import Control
from raysvc.scene import Environment, Scene
from raysvc.version import VERSION

OCCLUSION_OF_DIAGONAL = 1.0
"""How far ambient occlusion reaches by default, as a part of the scene's diagonal."""


def render(
    scene: Scene,
    environment: Environment | Mapping[str, Any] | None = None,
    camera: View | Mapping[str, Any] | None = None,
    settings: Settings | Mapping[str, Any] | None = None,
    *,
    control: Control | None = None,
    limits: Limits = DEFAULT_LIMITS,
) -> Frame:
    """Render one frame.

    Parameters
    ----------
    scene, environment
        what `raysvc.load` and `raysvc.load_environment` return; without an environment, a clear
        sky. Or the fields of a `Probe`, which captures what glossy surfaces reflect from a point of
        the scene, and `environment`, what is around that: an Environment, `builtin:NAME`, or None
    camera
        a `View` or its fields; without one, the scene's bounds are framed
    settings
        `Settings` or some of them
    control
        to stop the work and hear of its progress; its threads and deadline give way to the
        settings'

    The same arguments give the same bytes, whatever the number of threads. Tables and structures
    of a scene and environment are kept as long as those objects live, so a second frame is faster;
    those of deformed shapes of a scene until another shape is asked for, whose trees are refitted.

    Raises InvalidSetting, LimitExceeded, Unavailable, Cancelled, DeadlineExceeded.
    """
    settings = settings_from(settings)
    camera = {} if camera is None else camera
    view = camera if isinstance(camera, View) else checked(View, camera, "camera")
    resolved = camera_from(view, scene, limits)
    check_cost(settings, resolved, limits)
    control = (control or Control()).limited(settings.threads, settings.deadline_s)
    base, probe = surroundings(environment)
    if probe is not None:
        check_probe(probe, settings, scene)

    ledger = Ledger()
    with ledger.stage("prepare"):
        control.progress("prepare", 0.0)
        prepared = prepare(scene, base, settings, control)
        resolved = focused(resolved, view, prepared)
    illumination = Illumination(
        prepared,
        settings,
        settings.occlusion_radius or _occlusion_radius(scene),
        ledger,
    )
    rays = SecondaryRays(prepared, settings, illumination, ledger)
    draft = Draft(prepared, resolved, settings, control, ledger, illumination, rays, base, probe)
    for name, stage in STAGES[settings.mode]:
        control.check()
        with ledger.stage(name):
            stage(draft)
    statistics = Statistics(
        width=resolved.width,
        height=resolved.height,
        triangles=len(scene.triangles),
        structure=prepared.world.structure,
        threads=control.threads,
        stages=ledger.stages,
        total_seconds=ledger.total_seconds,
        rays=ledger.rays,
        bounces=ledger.bounces,
        shading=ledger.shading_cost(resolved.width * resolved.height),
        build={
            "seconds": prepared.seconds,
            "cached": prepared.cached,
            **prepared.fit.figures(),
        },
        edge_fraction=ledger.edge_fraction,
        max_coc_px=ledger.max_coc_px,
        environment=prepared.environment_cost,
        probe=ledger.probe,
        warnings=(
            *scene.warnings,
            *base.warnings,
            *prepared.warnings,
            *ledger.warnings,
        ),
        renderer_version=VERSION,
    )
    return Frame({"beauty": draft.beauty, **draft.layers}, statistics, settings)


def _occlusion_radius(scene: Scene) -> float:
    low, high = scene.bounds()
    return OCCLUSION_OF_DIAGONAL * float(np.linalg.norm(high - low)) or 1.0
