"""What part of constant light glTF's BRDF sends to a viewer, by brute-force quadrature."""

import numpy as np

from tests.oracles.brdf import gltf_lobes


def directional_albedo(cosine, base_colour, metallic, roughness, steps=500):
    """(3,) integral of the BRDF times N.L over the hemisphere, for a viewer at this cosine to the
    normal.

    The specular part is summed over half vectors spread as GGX has them, the diffuse over
    directions spread as the cosine: midpoints of steps x steps equal parts each.
    """
    normal = np.array([0.0, 0.0, 1.0])
    view = np.array([np.sqrt(1 - cosine**2), 0.0, cosine])
    middles = (np.arange(steps) + 0.5) / steps
    u, phi = (a.reshape(-1) for a in np.meshgrid(middles, 2 * np.pi * middles))

    alpha = max(roughness**2, 1e-3)
    cos_h = np.sqrt((1 - u) / (1 + (alpha**2 - 1) * u))
    half = _polar(cos_h, phi)
    voh = half @ view
    light = 2 * voh[:, None] * half - view
    _, specular = gltf_lobes(normal, view, light, base_colour, metallic, roughness)
    density = alpha**2 / (np.pi * (cos_h**2 * (alpha**2 - 1) + 1) ** 2) * cos_h / (4 * voh)
    specular = (specular * (light[:, 2] / density)[:, None])[(voh > 0) & (light[:, 2] > 0)]

    light = _polar(np.sqrt(1 - u), phi)
    diffuse, _ = gltf_lobes(normal, view, light, base_colour, metallic, roughness)
    return specular.sum(axis=0) / len(u) + np.pi * diffuse.mean(axis=0)


def _polar(cosine, phi):
    sine = np.sqrt(1 - cosine**2)
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), cosine], axis=1)
