"""glTF's metallic-roughness BRDF as the specification writes it (Appendix B), in NumPy, float64."""

import numpy as np


def fresnel(f0, cosine):
    return f0 + (1.0 - f0) * (1.0 - np.clip(cosine, 0.0, 1.0)) ** 5


def gltf_lobes(normal, view, light, base, metallic, roughness, dielectric_f0=0.04):
    """Diffuse and specular part of the BRDF.

    normal, view (3,) and light (L, 3) unit; base (3,); the rest scalars.
    Returns two (L, 3), without N.L, zero below the horizon.
    """
    alpha2 = max(roughness**2, 1e-3) ** 2
    half = light + view
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    nov, nol = float(normal @ view), light @ normal
    voh = half @ view
    f0 = dielectric_f0 * (1 - metallic) + np.asarray(base, float) * metallic
    f = fresnel(f0[None], voh[:, None])
    # 1 - N.H^2 through the cross product: exact for narrow lobes
    sine2 = (np.cross(normal, half) ** 2).sum(1)
    d = alpha2 / (np.pi * (sine2 * (1 - alpha2) + alpha2) ** 2)
    above = nol > 0
    nol = np.where(above, nol, 1.0)
    v = 0.5 / (
        nol * np.sqrt(nov**2 * (1 - alpha2) + alpha2)
        + nov * np.sqrt(nol**2 * (1 - alpha2) + alpha2)
    )
    diffuse = (1 - f) * np.asarray(base, float) * (1 - metallic) / np.pi
    specular = f * (v * d)[:, None]
    return diffuse * above[:, None], specular * above[:, None]
