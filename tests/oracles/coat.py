"""A varnished BRDF as KHR_materials_clearcoat writes it, in NumPy."""

import numpy as np

from tests.oracles.brdf import gltf_lobes


def coat_fresnel(view, normal):
    """clearcoat_fresnel of the extension."""
    return 0.04 + (1 - 0.04) * (1 - abs(float(np.dot(view, normal)))) ** 5


def coated(normal, view, light, base, coat):
    """BRDF times cosine of light, (L, 3); light (L, 3).

    `base` is (base_colour, metallic, roughness), `coat` (clearcoat, roughness, normal).
    """
    strength, roughness, coat_normal = coat
    diffuse, specular = gltf_lobes(normal, view, light, *base)
    # clearcoat_brdf = D G / (4 |V.Nc| |L.Nc|): the specular lobe with a Fresnel term of 1
    _, lobe = gltf_lobes(coat_normal, view, light, np.ones(3), 1.0, roughness)
    share = strength * coat_fresnel(view, coat_normal)
    under = (diffuse + specular) * np.maximum(light @ normal, 0)[:, None]
    over = lobe * np.maximum(light @ coat_normal, 0)[:, None]
    return under + share * (over - under)
