"""Integrals of an environment's light over its texels, to measure approximations by."""

import math

import numpy as np

from raysvc.jit import kernel
from raysvc.lighting.brdf import fresnel_weight, ggx_density, smith_visibility
from raysvc.lighting.lat_long import texel_directions, texel_solid_angles
from raysvc.types import Doubles, Floats

MIN_ROWS = 512
"""Of a map: enough for roughness 0.1."""


def outgoing(
    radiance: Floats,
    normal: Doubles,
    view: Doubles,
    roughness: Doubles,
    f0: float,
    min_rows: int = MIN_ROWS,
) -> Doubles:
    """Radiance that white surfaces return of a lat-long map.

    Parameters
    ----------
    radiance
        (H, W, 3) float32
    normal, view
        (N, 3), (N, 3) float64 unit, in the map's frame
    roughness
        (R,) float64
    f0
        reflectance at normal incidence
    min_rows
        coarser maps are refined to at least this many

    Returns
    -------
    (N, 1 + R, 3) float64: the diffuse lobe, then the specular lobe of each roughness
    """
    # One direction stands for a texel: coarse texels are cut until the narrowest lobe has several
    parts = -(-min_rows // len(radiance))
    radiance = radiance.repeat(parts, axis=0).repeat(parts, axis=1)
    height, width, _ = radiance.shape
    rows, columns = np.mgrid[0.5:height, 0.5:width]
    light = texel_directions(rows, columns, height, width).reshape(-1, 3)
    arriving = radiance * texel_solid_angles(height, width)[:, None, None]
    result = np.zeros((len(normal), 1 + len(roughness), 3))
    integrate(light, arriving.reshape(-1, 3), normal, view, roughness, f0, result)
    return result


@kernel
def integrate(
    light: Doubles,
    arriving: Doubles,
    normal: Doubles,
    view: Doubles,
    roughness: Doubles,
    f0: float,
    result: Doubles,
) -> None:
    """Add light from directions `light` (L, 3), radiance times solid angle, to `result`."""
    for i in range(len(normal)):
        nx, ny, nz = normal[i, 0], normal[i, 1], normal[i, 2]
        vx, vy, vz = view[i, 0], view[i, 1], view[i, 2]
        nov = nx * vx + ny * vy + nz * vz
        for t in range(len(light)):
            lx, ly, lz = light[t, 0], light[t, 1], light[t, 2]
            nol = nx * lx + ny * ly + nz * lz
            if nol <= 0.0:
                continue
            hx, hy, hz = lx + vx, ly + vy, lz + vz
            scale = 1.0 / math.sqrt(max(hx * hx + hy * hy + hz * hz, 1e-18))
            voh = (hx * vx + hy * vy + hz * vz) * scale
            noh = (hx * nx + hy * ny + hz * nz) * scale
            sine2 = max(1.0 - noh * noh, 0.0)
            fresnel = f0 + (1.0 - f0) * fresnel_weight(voh)
            for c in range(3):
                result[i, 0, c] += (1.0 - fresnel) * nol / math.pi * arriving[t, c]
            for k in range(len(roughness)):
                alpha = roughness[k] * roughness[k]
                lobe = fresnel * ggx_density(sine2, alpha) * smith_visibility(nol, nov, alpha)
                for c in range(3):
                    result[i, 1 + k, c] += lobe * nol * arriving[t, c]
