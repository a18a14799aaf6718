"""Light through a sheet without thickness (KHR_materials_transmission).

    f = transmission c_diff (1 - F) x lobe            c_diff = base (1 - metallic)

The sheet's two surfaces undo each other's refraction, so light goes straight on; their roughness
blurs it: "this microfacet lobe is exactly the same as the specular lobe except sampled along the
line of sight through the surface". So L is mirrored in the sheet and the lobe is that of
reflection, with the half vector that the extension calls H_T. Its notes write the separable form of
Smith's G, as those of the core do; raysvc has the height-correlated one in both. The index of
refraction sets F and nothing else: roughness blurs as much whatever the index.

The lobe's directional albedo is A of `albedo.py`: F has the weight x = (1 - V.H)^5, so that a sheet
reflects F0 A + B of constant light and lets through transmission c_diff (1 - F0) A.

Directions are unit, in a frame whose third axis is the normal on the viewer's side; light comes
from below.
"""

import numpy as np

from raysvc.geometry.vector_kernels import Vec3
from raysvc.jit import inlined
from raysvc.lighting.microfacet_reflection import reflection_lobe, reflection_sample
from raysvc.shading.brushed import Brushed
from raysvc.shading.coat import Coat
from raysvc.shading.glass import Glass
from raysvc.shading.rescattering import Rescattering
from raysvc.shading.surface import Surface


@inlined
def thin_lobe(view: Vec3, light: Vec3, alpha: float) -> tuple[float, float, float]:
    """The lobe and its density (per steradian), and V.H; 0, 0, 1 for light from above."""
    return reflection_lobe(view, (light[0], light[1], -light[2]), alpha)


@inlined
def thin_sample(
    view: Vec3, alpha: float, cos_turn: float, sin_turn: float, u: float
) -> tuple[Vec3, float, float]:
    """Direction of light out of the lobe, |N.L| f / pdf, and V.H; see `brdf.visible_normal`."""
    light, weight, voh = reflection_sample(view, alpha, cos_turn, sin_turn, u)
    return (light[0], light[1], -light[2]), weight, voh


def far_side(surface: Surface) -> Surface:
    """Turn sheets over, so that what they mirror is what comes through them.

    Returns
    -------
    Surface
        N points that face away from the viewer and are seen along the mirrored view, with a
        reflectance of 1 and nothing diffused. What lights, traces or filters the mirror lobe of
        surfaces does it for transmission with this one: the mean of light over its lobe, times
        the share that `boundary_albedo` says, is what comes through.
    """
    cosine = np.einsum("nk,nk->n", surface.normal, surface.to_viewer)[:, None]
    nothing, one = np.zeros(surface.size, np.float32), np.ones(surface.size, np.float32)
    return surface._replace(
        geometric_normal=-surface.geometric_normal,
        normal=-surface.normal,
        to_viewer=surface.to_viewer - 2.0 * cosine * surface.normal,
        base_colour=np.zeros((surface.size, 3), np.float32),
        metallic=nothing,
        dielectric_f0=one,
        transmission=nothing,
        emissive=np.zeros((surface.size, 3), np.float32),
        coat=Coat.empty(0),
        glass=Glass.empty(0),
        brushed=Brushed.empty(0),
        rescattering=Rescattering.empty(0),
    )
