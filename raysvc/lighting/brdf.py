"""glTF 2.0's metallic-roughness BRDF (specification, Appendix B) as scalar functions for kernels.

    f = (1 - F) c_diff / pi  +  F V D
    c_diff = base (1 - metallic)         F0 = lerp(dielectric_f0, base, metallic)
    F = F0 + (1 - F0) (1 - V.H)^5        Schlick 1994
    D, V with alpha = max(roughness^2, MIN_ALPHA): Walter et al. 2007, Heitz 2014

Every F0 shares one Fresnel weight x = (1 - V.H)^5, F = F0 (1 - x) + x; kernels carry x, no colours.
All cosines are of unit vectors in one hemisphere. Numba computes in the precision of its arguments.
"""

import math

from raysvc.jit import inlined

MIN_ALPHA = 1e-3
"""Narrowest lobe that the formula knows; a mirror is this lobe."""

MIRROR_ROUGHNESS = math.sqrt(MIN_ALPHA)
"""The mirror limit: up to it alpha is clamped, and environments are seen as they are."""

MIN_COSINE = 1e-4
"""Shading normals can turn away from the viewer; N.V is kept at least this."""


@inlined
def ggx_alpha(roughness: float) -> float:
    """GGX's alpha of a perceptual roughness in 0..1."""
    return max(roughness * roughness, MIN_ALPHA)


@inlined
def fresnel_weight(cosine: float) -> float:
    """Schlick's (1 - cosine)^5."""
    x = min(max(1.0 - cosine, 0.0), 1.0)
    return x * x * x * x * x


@inlined
def ggx_density(sine2: float, alpha: float) -> float:
    """D: microfacet normals per steradian and projected area; D N.H integrates to one.

    Takes the squared sine between N and H: 1 - N.H^2 has no digits left where alpha is small.
    """
    a2 = alpha * alpha
    t = sine2 * (1.0 - a2) + a2
    return a2 / (math.pi * t * t)


@inlined
def ggx_density_under_disc(sine2: float, alpha: float, radius2: float) -> float:
    """D averaged over a disc of half vectors, in closed form.

    In the plane of slopes, D cos^4 = alpha^2 / (pi (s^2 + alpha^2)^2) is what an element of area
    sees, at height alpha over the plane, of the plane's point at distance s. Its average over a
    disc is therefore the form factor of an element to a parallel disc (Howell, configuration B-13),
    over the disc's area.

    Parameters
    ----------
    sine2
        squared sine between N and the half vector of the disc's centre
    radius2
        squared radius of the disc in the plane of slopes; 0 gives D itself
    """
    a2 = alpha * alpha
    cosine2 = max(1.0 - sine2, 1e-6)
    beyond = sine2 / cosine2 + a2 - radius2
    root = math.sqrt(beyond * beyond + 4.0 * a2 * radius2)
    if beyond > 0.0:
        average = 2.0 * a2 / (math.pi * root * (root + beyond))
    else:
        average = (root - beyond) / (2.0 * math.pi * root * radius2)
    return average / (cosine2 * cosine2)


@inlined
def smith_root(cosine: float, alpha: float) -> float:
    """Root in Smith's terms for GGX: sqrt(cosine^2 (1 - alpha^2) + alpha^2)."""
    a2 = alpha * alpha
    return math.sqrt(cosine * cosine * (1.0 - a2) + a2)


@inlined
def smith_visibility(nol: float, nov: float, alpha: float) -> float:
    """V: height-correlated masking and shadowing G2, divided by 4 N.L N.V."""
    return 0.5 / max(nol * smith_root(nov, alpha) + nov * smith_root(nol, alpha), 1e-12)


@inlined
def masking(nov: float, alpha: float) -> float:
    """G1 of Smith's model: the share of microfacets that the viewer sees."""
    return 2.0 * nov / (nov + smith_root(nov, alpha))


@inlined
def shadowing_given_masking(nol: float, nov: float, alpha: float) -> float:
    """G2 / G1: what a sample of the visible normals weighs (Heitz 2018, equation 18)."""
    root_v = smith_root(nov, alpha)
    return nol * (nov + root_v) / max(nol * root_v + nov * smith_root(nol, alpha), 1e-12)


@inlined
def visible_normal(
    view: tuple[float, float, float], alpha: float, cos_turn: float, sin_turn: float, u: float
) -> tuple[float, float, float]:
    """Unit microfacet normal out of those that the viewer sees (Dupuy and Benyoub 2023).

    Parameters
    ----------
    view
        unit, in a frame whose third axis is the surface's normal; third component positive
    cos_turn, sin_turn, u
        cosine and sine of a uniform angle, and a uniform number in 0..1

    Reflecting `view` at it has the density G1 D / (4 N.V) per steradian. Unlike Heitz's method of
    2018 it needs no second frame around the view, so that it stays continuous where view and normal
    meet.
    """
    return stretched_visible_normal(view, alpha, alpha, cos_turn, sin_turn, u)


@inlined
def stretched_visible_normal(
    view: tuple[float, float, float],
    alpha_x: float,
    alpha_y: float,
    cos_turn: float,
    sin_turn: float,
    u: float,
) -> tuple[float, float, float]:
    """As `visible_normal`, of a lobe with different alphas along its first two axes."""
    # Stretch the view, take a point of the cap that it sees, shrink back
    vx, vy, vz = alpha_x * view[0], alpha_y * view[1], view[2]
    scale = 1.0 / math.sqrt(vx * vx + vy * vy + vz * vz)
    vx, vy, vz = vx * scale, vy * scale, vz * scale
    z = (1.0 - u) * (1.0 + vz) - vz
    sine = math.sqrt(max(1.0 - z * z, 0.0))
    hx = alpha_x * (sine * cos_turn + vx)
    hy = alpha_y * (sine * sin_turn + vy)
    hz = max(z + vz, 1e-9)
    scale = 1.0 / math.sqrt(hx * hx + hy * hy + hz * hz)
    return hx * scale, hy * scale, hz * scale
