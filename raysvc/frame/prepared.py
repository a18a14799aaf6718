"""What is made once for a scene or environment and serves many frames."""

import time
from dataclasses import dataclass

from raysvc.frame.kept import Kept
from raysvc.frame.settings import Settings
from raysvc.frame.shapes import fit_of, tables_of
from raysvc.frame.statistics import EnvironmentCost
from raysvc.lighting.image_light import Filtering, ImageLight
from raysvc.lighting.lamps import Lamps, lamps_of
from raysvc.lighting.rescattering import with_rescattering
from raysvc.parallel import Control
from raysvc.reference.emitters import Emitters
from raysvc.reference.environment import EnvironmentLight
from raysvc.reference.paths import Lights
from raysvc.scene import Environment, Scene
from raysvc.shading.scene_tables import SceneTables
from raysvc.shading.surface import Surface
from raysvc.tracing.fitting import Fit
from raysvc.tracing.patches import Patches
from raysvc.tracing.world import World

_LAMPS: Kept[Scene, Lamps] = Kept()
_PATCHES: Kept[Scene, Patches] = Kept()
_LIGHTS: Kept[Environment, ImageLight] = Kept()
_SKIES: Kept[Environment, EnvironmentLight] = Kept()
_EMITTERS: Kept[Scene, Emitters] = Kept()


@dataclass(frozen=True, slots=True)
class Prepared:
    """Everything that a frame reads and no frame changes."""

    scene: Scene
    tables: SceneTables
    fit: Fit
    light: ImageLight
    environment_cost: EnvironmentCost
    lamps: Lamps
    patches: Patches | None
    """Between which light goes back and forth; None where no ambient light is wanted."""
    path_lights: Lights | None
    """What paths look for; only in reference mode."""
    seconds: float
    """What making it took."""
    cached: bool
    """Nothing had to be made."""
    warnings: tuple[str, ...]
    """What could not be made as asked."""
    rescatters: bool
    """Specular lobes are compensated for what microfacets scatter more than once."""

    @property
    def world(self) -> World:
        """What answers the scene's rays."""
        return self.fit.world

    def lobes_of(self, surface: Surface) -> Surface:
        """Return points with their specular lobes as the frame wants them: compensated or not."""
        return with_rescattering(surface) if self.rescatters else surface


def prepare(
    scene: Scene, environment: Environment, settings: Settings, control: Control | None = None
) -> Prepared:
    """Make, or find again, the tables and structures of a scene and the filters of an
    environment. Raises Cancelled and DeadlineExceeded, though not while a structure is built."""
    start = time.perf_counter()
    control = (control or Control(settings.threads)).quiet()
    turned = settings.environment_yaw_deg, settings.environment_strength
    tables, had_tables = tables_of(scene)
    control.check()
    fit, had_fit = fit_of(scene, tables, settings.structure, settings.trees)
    control.check()
    filtering = Filtering(
        settings.ibl, settings.ibl_order, settings.sat_builder, settings.ibl_lobe_samples
    )
    light, had_light = _LIGHTS.get(
        environment,
        (turned, filtering),
        lambda: ImageLight(environment, *turned, filtering, control),
    )
    phong_seconds = 0.0
    if settings.mode == "hybrid" and (tables.brushed or tables.glassy):
        # Here, that not all of the frame's threads wait for one of them
        phong_seconds = light.make_phong()
    cached = had_tables and had_fit and had_light and not phong_seconds
    warnings: tuple[str, ...] = ()
    if settings.texture_filter == "sat" and settings.mode == "hybrid":
        cached = cached and tables.sums.are_made
        tables.sums.made()
        warnings = tables.sums.warnings
    path_lights = None
    if settings.mode == "reference":
        sky, had_sky = _SKIES.get(
            environment, turned, lambda: EnvironmentLight(environment, *turned)
        )
        emitters, had_emitters = _EMITTERS.get(scene, None, lambda: Emitters(scene, tables))
        path_lights = Lights(sky, emitters, scene.lights)
        cached = cached and had_sky and had_emitters
    lamps, had_lamps = _LAMPS.get(scene, None, lambda: lamps_of(scene, tables))
    control.check()
    patches, had_patches = None, True
    if settings.mode == "hybrid" and settings.occlusion_samples > 0:
        patches, had_patches = _PATCHES.get(scene, None, lambda: Patches.of(scene, tables))
    return Prepared(
        scene,
        tables,
        fit,
        light,
        EnvironmentCost(
            rebuilt=not had_light,
            seconds=(0.0 if had_light else light.seconds) + phong_seconds,
            ibl=settings.ibl,
            order=settings.ibl_order,
            builder=settings.sat_builder,
            passes=light.passes,
            suns=len(light.suns),
        ),
        lamps,
        patches,
        path_lights,
        time.perf_counter() - start,
        cached and had_lamps and had_patches,
        warnings,
        settings.multiple_scattering,
    )
