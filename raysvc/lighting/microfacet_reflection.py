"""The mirror lobe of a rough surface: glTF's specular BRDF without its Fresnel term.

    f = G2 D / (4 N.L N.V)          N.L f / pdf = G2 / G1(V)

Directions are unit, in a frame whose third axis is the normal on the viewer's side. A varnish
(KHR_materials_clearcoat) is this lobe about its own normal, weighted by `clearcoat.coat_share`.
"""

import math

from raysvc.geometry.vector_kernels import Vec3
from raysvc.jit import inlined
from raysvc.lighting.brdf import (
    MIN_COSINE,
    ggx_density,
    masking,
    shadowing_given_masking,
    smith_visibility,
    visible_normal,
)


@inlined
def reflection_lobe(view: Vec3, light: Vec3, alpha: float) -> tuple[float, float, float]:
    """The lobe, its density when visible normals are sampled (both per steradian), and V.H.

    0, 0, 1 unless both directions are above the surface.
    """
    nol = light[2]
    if nol <= 0.0 or view[2] <= 0.0:
        return 0.0, 0.0, 1.0
    nov = max(view[2], MIN_COSINE)
    hx, hy, hz = view[0] + light[0], view[1] + light[1], view[2] + light[2]
    across, square = hx * hx + hy * hy, hx * hx + hy * hy + hz * hz
    density = ggx_density(across / square, alpha)
    lobe = smith_visibility(nol, nov, alpha) * density
    voh = (view[0] * hx + view[1] * hy + view[2] * hz) / math.sqrt(square)
    return lobe, masking(nov, alpha) * density / (4.0 * nov), voh


@inlined
def reflection_sample(
    view: Vec3, alpha: float, cos_turn: float, sin_turn: float, u: float
) -> tuple[Vec3, float, float]:
    """Direction of light out of the lobe, N.L f / pdf, and V.H; see `brdf.visible_normal`.

    The weight is 0 where the direction is below the surface.
    """
    nov = max(view[2], MIN_COSINE)
    h = visible_normal((view[0], view[1], nov), alpha, cos_turn, sin_turn, u)
    voh = view[0] * h[0] + view[1] * h[1] + nov * h[2]
    k = 2.0 * voh
    light = (k * h[0] - view[0], k * h[1] - view[1], k * h[2] - nov)
    weight = shadowing_given_masking(light[2], nov, alpha) if light[2] > 0.0 else 0.0
    return light, weight, voh
