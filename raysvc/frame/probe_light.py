"""What glossy surfaces show of a captured probe, in place of rays.

    lobe of everything captured but lamps and sun
    + lobe of lamps, as far as their highlight is left to what is mirrored
    + the sun itself in the mirror limit, where nothing is in its way

The tables of a captured map take a small bright light out of it as they do with any map; here it is
put back as a highlight, so that nothing that was captured is lost or counted twice.
"""

import math
from dataclasses import dataclass

import numpy as np

from raysvc.frame.prepared import Prepared
from raysvc.frame.radiance import specular_lobe
from raysvc.frame.statistics import Ledger
from raysvc.lighting.albedo import specular_albedo
from raysvc.lighting.brdf import MIRROR_ROUGHNESS
from raysvc.lighting.brushed_light import round_roughness
from raysvc.lighting.direct import arriving, reflected
from raysvc.lighting.image_light import ImageLight
from raysvc.lighting.lamps import highlight
from raysvc.shading.surface import Surface
from raysvc.tracing.reflection import mirror_rays
from raysvc.types import Floats

WITHOUT_SUN_RAD = 0.004
"""Half width from which on cones of an environment are surely without its sun's disc."""
SUN_BORDER_RAD = 0.01
"""About a sun's disc, within which its texels are."""


@dataclass(frozen=True, slots=True, eq=False)
class Captured:
    """What is around a point, as light."""

    around: ImageLight
    """Everything but lamps and the base environment's sun."""
    lamps: ImageLight | None
    """The lamps alone; None where none is seen."""
    left_out: int
    """Triangles that the probe did not see."""
    capture_seconds: float
    tables_seconds: float


class ProbeLight:
    """A captured probe as points see it; its methods take chunks and may run on many threads."""

    def __init__(self, captured: Captured, prepared: Prepared, ledger: Ledger) -> None:
        self._captured, self._ledger = captured, ledger
        self._base, self._world = prepared.light, prepared.world

    def lobe(self, surface: Surface, seen: Floats) -> Floats:
        """(N, 3) radiance that the specular lobe returns.

        `seen` (N, 3) is what of constant light would be seen: where that is faint, one lookup does.
        """
        total = self._lobe_of(self._captured.around, surface, seen)
        if self._captured.lamps is not None:
            smooth = 1.0 - highlight(round_roughness(surface))
            index = np.flatnonzero(smooth > 0.0)
            lamps = self._lobe_of(self._captured.lamps, surface.chosen(index), seen[index])
            total[index] += lamps * smooth[index, None]
        self._add_sun_in_mirrors(surface, total)
        return total

    def _lobe_of(self, light: ImageLight, surface: Surface, seen: Floats) -> Floats:
        """(N, 3) of all light of a captured map, whether its tables hold it or not."""
        total = specular_lobe(light, surface, seen)
        for sun in light.suns:
            to_light, _, irradiance = arriving(sun, surface.position)
            without_diffuse = _as_metal(surface)
            total += reflected(without_diffuse, to_light, irradiance, sun.angular_radius_rad)
        return total

    def _add_sun_in_mirrors(self, surface: Surface, total: Floats) -> None:
        """Add the base environment's suns to points (N, 3) in the mirror limit that look at it."""
        mirror = np.flatnonzero(surface.roughness <= MIRROR_ROUGHNESS)
        if not self._base.suns or not len(mirror):
            return
        directions = mirror_rays(surface.chosen(mirror)).directions
        pixel_rad = _pixel_rad(surface.chosen(mirror))
        looks = np.zeros(len(mirror), bool)
        for sun in self._base.suns:
            reach = 2.0 * sun.angular_radius_rad + SUN_BORDER_RAD + pixel_rad
            looks |= directions @ np.array(sun.direction, np.float32) > np.cos(reach)
        point = mirror[looks]
        if not len(point):
            return
        looking = surface.chosen(point)
        rays = mirror_rays(looking)
        # A cone with the variance of the pixel's square
        width = np.maximum(_pixel_rad(looking) / np.float32(math.sqrt(3.0)), WITHOUT_SUN_RAD)
        without = specular_albedo(looking) * self._base.cone(rays.directions, width)
        disc = self._base.specular(looking) - without
        self._ledger.count("shadow", len(point))
        free = self._world.transmittance(rays)
        total[point] += np.maximum(disc, 0.0) * free[:, None]


def _pixel_rad(surface: Surface) -> Floats:
    """(N,) side of the square that a pixel sees mirrored."""
    if not surface.mirrored.size:
        return np.zeros(surface.size, np.float32)
    side: Floats = np.sqrt(surface.mirrored.pixel_sr)
    return side


def _as_metal(surface: Surface) -> Surface:
    """The same points with the same specular lobe, and no diffuse one."""
    metallic = surface.metallic[:, None]
    f0 = surface.dielectric_f0[:, None] * (1.0 - metallic) + surface.base_colour * metallic
    return surface._replace(base_colour=f0, metallic=np.ones_like(surface.metallic))
