"""How often paths follow each lobe of a material."""

import numpy as np

from raysvc.lighting.albedo import albedo_tables
from raysvc.lighting.boundary_albedo import boundary_albedo
from raysvc.reference.choice_kernels import LOBES, lobe_choices
from raysvc.shading.surface import Surface
from raysvc.types import Doubles


def choices_of(surface: Surface) -> Doubles:
    """(N, LOBES) odds of the lobes of N points, in the order of `choice_kernels`; they sum to 1."""
    reflected = transmitted = np.empty((0, 3), np.float32)
    if surface.glass.size:
        reflected, transmitted = boundary_albedo(surface)
    tables = albedo_tables()
    choice = np.empty((surface.size, LOBES))
    lobe_choices(tables.specular, tables.diffuse, reflected, transmitted, surface, choice)
    return choice
