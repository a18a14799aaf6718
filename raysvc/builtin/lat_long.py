"""Where the texels of an environment look, and how much of all directions each covers."""

import numpy as np

from raysvc.types import Doubles


def texel_directions(height: int, width: int) -> Doubles:
    """(height, width, 3) unit directions of texel centres.

    The centre column looks along -Z, columns to its right towards +X; row 0 looks up (+Y).
    """
    azimuth = 2.0 * np.pi * ((np.arange(width) + 0.5) / width - 0.5)
    polar = np.pi * (np.arange(height) + 0.5) / height
    level, up = np.sin(polar)[:, None], np.cos(polar)[:, None]
    return np.stack(
        [
            level * np.sin(azimuth),
            np.broadcast_to(up, (height, width)),
            -level * np.cos(azimuth),
        ],
        axis=2,
    )


def texel_solid_angles(height: int, width: int) -> Doubles:
    """(height, 1) exact solid angle in steradians of a texel of each row."""
    edges = np.cos(np.pi * np.arange(height + 1) / height)
    return (2.0 * np.pi / width * (edges[:-1] - edges[1:]))[:, None]


def irradiance(radiance: Doubles, facing: Doubles) -> Doubles:
    """(3,) irradiance of a surface that faces `facing` (3,), from (H, W, 3) radiance."""
    height, width = radiance.shape[:2]
    cosine = np.maximum(texel_directions(height, width) @ facing, 0.0)
    weight = cosine * texel_solid_angles(height, width)
    return np.asarray(np.einsum("hw,hwc->c", weight, radiance))
