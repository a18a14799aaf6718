"""Light inside of a sphere whose wall shines and reflects by glTF's BRDF.

A chord meets the wall at equal angles at both its ends. So the light that arrives at a point at
some angle to the wall left the wall at the same angle, and each bounce is an integral over one
cosine.
"""

import numpy as np

from tests.oracles.brdf import gltf_lobes


def light_after_bounces(cosine, base, metallic, roughness, bounces, steps=120):
    """(bounces + 1,) of one channel: what the wall of emission 1 shows to a viewer inside.

    Entry k has light reflected at most k times. `cosine` is the viewer's, to the wall.
    """
    middles = (np.arange(steps) + 0.5) / steps
    weights = 2 * middles / steps  # of cos d(cos), with cosines spread as u^2: fine at the horizon
    cosines = middles**2
    transfer = np.array([_row(c, cosines, base, metallic, roughness) for c in cosines])
    seen = _row(cosine, cosines, base, metallic, roughness)
    arriving, total = np.ones(steps), [1.0]
    for _ in range(bounces):
        reflected = seen @ (weights * cosines * arriving)
        total.append(1.0 + reflected)
        arriving = 1.0 + transfer @ (weights * cosines * arriving)
    return np.array(total)


def _row(cosine, cosines, base, metallic, roughness, turns=64):
    """BRDF integrated over azimuth, from all cosines to one."""
    normal = np.array([0.0, 0.0, 1.0])
    view = np.array([np.sqrt(1 - cosine**2), 0.0, cosine])
    turn = (np.arange(turns) + 0.5) / turns * np.pi
    sine = np.sqrt(1 - cosines**2)
    light = np.stack(
        [
            np.outer(sine, np.cos(turn)),
            np.outer(sine, np.sin(turn)),
            np.outer(cosines, np.ones(turns)),
        ],
        axis=-1,
    ).reshape(-1, 3)
    value = sum(gltf_lobes(normal, view, light, (base,) * 3, metallic, roughness))[:, 0]
    return value.reshape(len(cosines), turns).mean(axis=1) * 2 * np.pi
