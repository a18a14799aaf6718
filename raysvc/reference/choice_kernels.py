"""How often paths follow each lobe of a material: as much as it returns of constant light."""

from raysvc.jit import inlined, kernel
from raysvc.lighting.albedo_kernels import diffuse_loss, lobe_terms
from raysvc.lighting.clearcoat import coat_share
from raysvc.shading.rescattering_kernels import rescattered
from raysvc.shading.surface import Surface
from raysvc.types import Doubles, Floats

COAT, MIRROR, DIFFUSE, THROUGH = range(4)
"""Lobes: of varnish, of reflection, of diffusion, and of what goes through glass."""
LOBES = 4


@inlined
def luminance(red: float, green: float, blue: float) -> float:
    """Of linear Rec.709."""
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


@inlined
def coat_of(surface: Surface, n: int) -> float:
    """Share of the varnish on a point: of the light that it shows, and of what lies under it."""
    if len(surface.coat.clearcoat) == 0 or surface.coat.clearcoat[n] <= 0.0:
        return 0.0
    cosine = (
        surface.coat.normal[n, 0] * surface.to_viewer[n, 0]
        + surface.coat.normal[n, 1] * surface.to_viewer[n, 1]
        + surface.coat.normal[n, 2] * surface.to_viewer[n, 2]
    )
    return coat_share(float(surface.coat.clearcoat[n]), float(cosine))


@kernel
def lobe_choices(
    terms: Doubles,
    losses: Doubles,
    reflected: Floats,
    transmitted: Floats,
    surface: Surface,
    choice: Doubles,
) -> None:
    """Fill choice (N, LOBES) with the odds of each lobe, which sum to 1.

    `terms` and `losses` are tables of `lighting.albedo`. In a scene with glass `reflected` and
    `transmitted` (N, 3) are those of `lighting.boundary_albedo`, else they have no rows.
    """
    for n in range(len(surface.normal)):
        cosine = (
            surface.normal[n, 0] * surface.to_viewer[n, 0]
            + surface.normal[n, 1] * surface.to_viewer[n, 1]
            + surface.normal[n, 2] * surface.to_viewer[n, 2]
        )
        metal = surface.metallic[n]
        base = luminance(
            surface.base_colour[n, 0], surface.base_colour[n, 1], surface.base_colour[n, 2]
        )
        dielectric = surface.dielectric_f0[n]
        if len(reflected) > 0:
            mirror = luminance(reflected[n, 0], reflected[n, 1], reflected[n, 2])
            through = luminance(transmitted[n, 0], transmitted[n, 1], transmitted[n, 2])
        else:
            scale, bias = lobe_terms(terms, surface, n, cosine)
            f0 = dielectric * (1.0 - metal) + base * metal
            mirror = (f0 * scale + bias) * rescattered(surface, n, f0)
            through = 0.0
        diffuse = base * (1.0 - metal) * (1.0 - surface.transmission[n]) * (1.0 - dielectric)
        diffuse *= 1.0 - diffuse_loss(losses, cosine)
        total = mirror + diffuse + through
        coat = coat_of(surface, n)
        under = (1.0 - coat) / total if total > 0.0 else 0.0
        choice[n, COAT] = coat
        choice[n, MIRROR] = mirror * under
        choice[n, DIFFUSE] = diffuse * under
        choice[n, THROUGH] = through * under
