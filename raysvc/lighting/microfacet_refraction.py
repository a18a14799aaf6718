"""Light through the boundary of a solid (KHR_materials_volume; Walter et al. 2007).

    f = transmission c_diff (1 - F) x lobe            c_diff = base (1 - metallic)
    lobe = |H.L| |H.V| / (|N.L| |N.V|)  x  G1(V) G1(L) D / (eta H.V + H.L)^2
    H = -(eta V + L), normalised: the facet that refracts one into the other

Fresnel's term is Schlick's on the thin side of the boundary, as the extension has it, and 1 at
total reflection. `eta` is as in `geometry.refraction`: index on the viewer's side over that on the
light's, and not 1.

Units. Radiance divided by the square of the index of the medium is what a boundary keeps
(Nicodemus 1963): that is what raysvc carries along rays. Walter's equation 21 is for radiance
itself and has another factor (n_V / n_L)^2; on a path from the camera the factors of going in and
coming out cancel, so only lights that are inside a solid would look different. Without it the
formula is the extension's, no throughput depends on the medium, and
n_V^2 f(V, L) = n_L^2 f(L, V) is the law of reciprocity.

Directions are unit, in a frame whose third axis is the normal on the viewer's side; light comes
from below.
"""

import math

from raysvc.geometry.refraction import refracted, transmitted_cosine
from raysvc.geometry.vector_kernels import Vec3, dot
from raysvc.jit import inlined
from raysvc.lighting.brdf import MIN_COSINE, fresnel_weight, ggx_density, masking, visible_normal


@inlined
def boundary_fresnel_weight(cosine: float, eta: float) -> float:
    """Schlick's x at a boundary, so that F = F0 (1 - x) + x; 1 at total reflection.

    `cosine` is V.H. The cosine on the thin side counts, for both directions of one path must have
    the same F.
    """
    if eta <= 1.0:
        return fresnel_weight(cosine)
    return fresnel_weight(transmitted_cosine(cosine, eta))


@inlined
def refraction_lobe(
    view: Vec3, light: Vec3, eta: float, alpha: float
) -> tuple[float, float, float]:
    """The lobe, its density when visible normals are sampled (both per steradian), and V.H.

    0, 0, 1 where no facet refracts one direction into the other.
    """
    nol = -light[2]
    if nol <= 0.0 or view[2] <= 0.0:
        return 0.0, 0.0, 1.0
    nov = max(view[2], MIN_COSINE)
    hx, hy, hz = eta * view[0] + light[0], eta * view[1] + light[1], eta * view[2] + light[2]
    across, square = hx * hx + hy * hy, hx * hx + hy * hy + hz * hz
    scale = 1.0 / math.sqrt(max(square, 1e-300))
    if hz < 0.0:
        scale = -scale
    h = (hx * scale, hy * scale, hz * scale)
    voh, loh = dot(view, h), -dot(light, h)
    if voh <= 0.0 or loh <= 0.0:
        return 0.0, 0.0, 1.0
    facet = ggx_density(across / max(square, 1e-300), alpha) * masking(nov, alpha)
    # d_omega_h / d_omega_l; eta H.V + H.L is the length of eta V + L
    density = facet * voh / nov * loh / max(square, 1e-300)
    return density * masking(nol, alpha) / nol, density, voh


@inlined
def refraction_sample(
    view: Vec3, eta: float, alpha: float, cos_turn: float, sin_turn: float, u: float
) -> tuple[Vec3, float, float]:
    """Direction of light out of the lobe, |N.L| f / pdf, and V.H; see `brdf.visible_normal`.

    The weight is 0 at total reflection and where the direction is above the surface.
    """
    nov = max(view[2], MIN_COSINE)
    towards = (view[0], view[1], nov)
    h = visible_normal(towards, alpha, cos_turn, sin_turn, u)
    light, far = refracted(towards, h, eta)
    weight = 0.0
    if far > 0.0 and light[2] < 0.0:
        weight = masking(-light[2], alpha)
    return light, weight, dot(towards, h)
