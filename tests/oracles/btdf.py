"""Transmission lobes as the glTF extensions write them, and Fresnel's equations, in NumPy.

All directions are in a frame whose third axis is the normal on the viewer's side.
"""

import numpy as np


def _density(cosine, alpha):
    """D of KHR_materials_transmission's notes."""
    return alpha**2 / (np.pi * (cosine**2 * (alpha**2 - 1) + 1) ** 2)


def _masking(cosine, alpha):
    """One of the two factors of the separable G_T."""
    cosine = np.abs(cosine)
    return 2 * cosine / (cosine + np.sqrt(alpha**2 + (1 - alpha**2) * cosine**2))


def refraction(view, light, ior_i, ior_o, alpha):
    """MicrofacetBTDF of KHR_materials_volume at light (L, 3) below the surface, and V.H (L,).

    `ior_i` is on the side of `view`, `ior_o` on that of the light.
    """
    half = -(ior_i * view + ior_o * light)
    half /= np.linalg.norm(half, axis=-1, keepdims=True)
    # The normal of the facet, on the side of the surface's
    half = np.where(half[:, 2:] < 0, -half, half)
    voh, loh = half @ view, (half * light).sum(-1)
    nov, nol = view[2], light[:, 2]
    value = np.abs(loh) * np.abs(voh) / (np.abs(nol) * np.abs(nov))
    value = value * ior_o**2 * _masking(nol, alpha) * _masking(nov, alpha)
    value = value * _density(half[:, 2], alpha) / (ior_i * voh + ior_o * loh) ** 2
    return np.where((voh > 0) & (loh < 0) & (nol < 0), value, 0), voh


def schlick_weight(voh, ior_i, ior_o):
    """(1 - cos)^5 of the three cases of KHR_materials_volume, as a share beyond F0."""
    if ior_o >= ior_i:
        return (1 - np.abs(voh)) ** 5
    sine2 = (ior_i / ior_o) ** 2 * (1 - np.square(voh))
    return np.where(sine2 < 1, (1 - np.sqrt(np.maximum(1 - sine2, 0))) ** 5, 1.0)


def exact_fresnel(cosine, ior_i, ior_o):
    """Reflectance of unpolarised light at a smooth boundary."""
    sine2 = (ior_i / ior_o) ** 2 * (1 - cosine**2)
    far = np.sqrt(np.maximum(1 - sine2, 0))
    across = (ior_i * cosine - ior_o * far) / (ior_i * cosine + ior_o * far)
    along = (ior_o * cosine - ior_i * far) / (ior_o * cosine + ior_i * far)
    return np.where(sine2 < 1, 0.5 * (across**2 + along**2), 1.0)


def hemisphere(cosines, turns, below=True):
    """Directions (cosines * turns, 3) at midpoints of equal solid angles, and that angle."""
    z = np.repeat((np.arange(cosines) + 0.5) / cosines, turns)
    phi = np.tile((np.arange(turns) + 0.5) / turns * 2 * np.pi, cosines)
    s = np.sqrt(1 - z**2)
    sign = -1 if below else 1
    return np.stack([s * np.cos(phi), s * np.sin(phi), sign * z], axis=1), 2 * np.pi / len(z)
