"""A clear varnish on a surface (KHR_materials_clearcoat).

    coated = mix(base, lobe, s)      s = clearcoat (0.04 + 0.96 (1 - |V.Nc|)^5)

`lobe` is the mirror lobe of `microfacet_reflection` about the coat's normal Nc, with the coat's
roughness. Its Fresnel term is that of the smooth coat seen along V and not that of each facet, so
what the coat takes from the base does not depend on where light comes from. Emission is darkened
like everything else underneath. Light that the coat scatters more than once is left out, for hardly
any of it comes back: F0 is 0.04.
"""

from dataclasses import dataclass

import numpy as np

from raysvc.jit import inlined, kernel
from raysvc.lighting.brdf import fresnel_weight
from raysvc.shading.brushed import Brushed
from raysvc.shading.coat import Coat
from raysvc.shading.glass import Glass
from raysvc.shading.rescattering import Rescattering
from raysvc.shading.surface import Surface
from raysvc.types import Floats, Longs

COAT_F0 = 0.04
"""The varnish has the index 1.5."""


@inlined
def coat_share(clearcoat: float, cosine: float) -> float:
    """s: the share of the coat's lobe, with `cosine` V.Nc; 1 - s is that of the base."""
    return clearcoat * (COAT_F0 + (1.0 - COAT_F0) * fresnel_weight(abs(cosine)))


@kernel
def coat_shares(surface: Surface, point: Longs, share: Floats) -> None:
    """Write s of some points (K,) of a surface that has a coat to `share` (K, 1)."""
    for k in range(len(point)):
        i = point[k]
        cosine = (
            surface.coat.normal[i, 0] * surface.to_viewer[i, 0]
            + surface.coat.normal[i, 1] * surface.to_viewer[i, 1]
            + surface.coat.normal[i, 2] * surface.to_viewer[i, 2]
        )
        share[k, 0] = coat_share(surface.coat.clearcoat[i], cosine)


@dataclass(frozen=True, slots=True, eq=False)
class Varnish:
    """The coat of those points of a surface that have one."""

    point: Longs
    """(K,) which points, ascending."""
    share: Floats
    """(K, 1) of the coat's lobe; what the base shows is scaled by 1 - share."""
    surface: Surface
    """(K,) the coat as a surface of its own, without diffuse light and with a reflectance of 1: the
    mirror lobe alone. Whatever lights surfaces lights this one."""

    @classmethod
    def of(cls, surface: Surface) -> "Varnish":
        """Find what is varnished; unlit points are not."""
        point = np.flatnonzero(surface.coat.clearcoat > 0.0)
        point = point[~surface.unlit[point]]
        share = np.empty((len(point), 1), np.float32)
        coat_shares(surface, point, share)
        under = surface.chosen(point)
        nothing, one = np.zeros(len(point), np.float32), np.ones(len(point), np.float32)
        lobe = under._replace(
            normal=under.coat.normal,
            base_colour=np.zeros((len(point), 3), np.float32),
            metallic=nothing,
            roughness=under.coat.roughness,
            dielectric_f0=one,
            transmission=nothing,
            emissive=np.zeros((len(point), 3), np.float32),
            coat=Coat.empty(0),
            glass=Glass.empty(0),
            brushed=Brushed.empty(0),
            rescattering=Rescattering.empty(0),
        )
        return cls(point, share, lobe)

    def laid_over(self, base: Floats, coat: Floats) -> None:
        """Mix what the coat shows, (K, 3), over what the base shows, (N, 3), in place."""
        base[self.point] += self.share * (coat - base[self.point])
