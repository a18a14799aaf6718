"""Anisotropic GGX as KHR_materials_anisotropy writes it, in NumPy, float64."""

import numpy as np

from tests.oracles.brdf import fresnel
from tests.oracles.lobe import map_directions


def alphas(roughness, strength):
    """alpha_t, alpha_b."""
    alpha = max(roughness**2, 1e-3)
    return alpha + (1 - alpha) * strength**2, alpha


def brushed_lobe(axes, view, light, f0, roughness, strength):
    """F V D (L, 3), without N.L: axes (3, 3) are rows T, B, N; view (3,), light (L, 3) unit."""
    at, ab = alphas(roughness, strength)
    half = light + view
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    ht, hb, hn = (half @ axis for axis in axes)
    vt, vb, vn = (view @ axis for axis in axes)
    lt, lb, ln = (light @ axis for axis in axes)
    a2 = at * ab
    f = np.stack([ab * ht, at * hb, a2 * hn], axis=1)
    w2 = a2 / (f * f).sum(axis=1)
    density = a2 * w2 * w2 / np.pi
    ggx_v = ln * np.sqrt((at * vt) ** 2 + (ab * vb) ** 2 + vn**2)
    ggx_l = vn * np.sqrt((at * lt) ** 2 + (ab * lb) ** 2 + ln**2)
    visibility = np.where(ln > 0, 0.5 / np.where(ln > 0, ggx_v + ggx_l, 1), 0)
    return (
        fresnel(np.asarray(f0, float)[None], (half @ view)[:, None])
        * ((visibility * density)[:, None])
    )


def outgoing(radiance, axes, view, f0, roughness, strength):
    """(3,) specular radiance towards `view`, summed over all texels of a lat-long map."""
    light, angles = map_directions(*radiance.shape[:2])
    lobe = brushed_lobe(axes, view, light, f0, roughness, strength)
    arriving = radiance.reshape(-1, 3) * (angles * np.maximum(light @ axes[2], 0))[:, None]
    return (lobe * arriving).sum(0)
