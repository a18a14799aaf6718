"""Light that microfacets scatter more than once, and glTF's formula loses.

    lobe x (1 + F0 (1 / E - 1))      E = A + B: what a white lobe returns of constant light

Turquin 2019, "Practical multiple scattering compensation for microfacet models": what is missing
has the shape of the lobe, and F0 of it comes back. A white metal then returns everything at every
roughness; a dielectric gains little. Light that goes through glass, and what glass reflects inside
of itself, are left as they are.
"""

import numpy as np

from raysvc.lighting.albedo import albedo_tables
from raysvc.lighting.rescattering_kernels import missing_energies
from raysvc.shading.rescattering import Rescattering
from raysvc.shading.surface import Surface


def with_rescattering(surface: Surface) -> Surface:
    """Return points whose specular lobes are compensated from now on, in whatever lights them.

    It is of their normal, viewer and roughness: whoever changes those asks again.
    """
    missing = np.empty(surface.size, np.float32)
    missing_energies(albedo_tables().specular, surface, missing)
    return surface._replace(rescattering=Rescattering(missing))
