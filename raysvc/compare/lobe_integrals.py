"""Integrals of an environment's light over all of its texels: what filters are measured by."""

import math

import numpy as np

from raysvc.jit import inlined, kernel
from raysvc.lighting.brdf import fresnel_weight, ggx_density, smith_visibility
from raysvc.lighting.lat_long import texel_solid_angles
from raysvc.types import Doubles, Floats

NEAR_RAD = math.radians(4.0)
"""Texels as near as this to the middle of a lobe are cut into CUT x CUT parts."""
CUT = 12


def diffuse_integrals(radiance: Floats, normal: Doubles, view: Doubles, f0: float) -> Doubles:
    """Radiance (N, 3) float64 that white surfaces diffuse of a lat-long map (H, W, 3) float32.

    Normals and views are (N, 3) float64 unit, in the map's frame; `f0` is the reflectance at normal
    incidence, of which the rest is diffused: (1 - F) cosine / pi.
    """
    result = np.zeros((len(normal), 3))
    integrate_diffuse(radiance, texel_solid_angles(*radiance.shape[:2]), normal, view, f0, result)
    return result


def specular_integrals(
    radiance: Floats, normal: Doubles, view: Doubles, roughness: float, f0: float
) -> Doubles:
    """Radiance (N, 3) float64 that surfaces reflect of a map by glTF's specular lobe."""
    result = np.zeros((len(normal), 3))
    angles = texel_solid_angles(*radiance.shape[:2])
    integrate_specular(radiance, angles, normal, view, roughness * roughness, f0, result)
    return result


def phong_integrals(radiance: Floats, towards: Doubles, exponent: float) -> Doubles:
    """Mean radiance (N, 3) float64 of a map under lobes cos^exponent about unit directions."""
    result = np.zeros((len(towards), 3))
    angles = texel_solid_angles(*radiance.shape[:2])
    integrate_phong(radiance, angles, towards, exponent, result)
    return result


@inlined
def _direction(row: float, column: float, height: int, width: int) -> tuple[float, float, float]:
    """Unit direction of a place of a map, in texels from its corner."""
    polar, azimuth = row / height * math.pi, (column / width - 0.5) * 2.0 * math.pi
    sine = math.sin(polar)
    return sine * math.sin(azimuth), math.cos(polar), -sine * math.cos(azimuth)


@kernel
def integrate_diffuse(
    radiance: Floats, angles: Doubles, normal: Doubles, view: Doubles, f0: float, result: Doubles
) -> None:
    """Add the diffuse lobe's integral to `result` (N, 3); texels of row i have angles[i] sr."""
    height, width = radiance.shape[0], radiance.shape[1]
    for row in range(height):
        for column in range(width):
            lx, ly, lz = _direction(row + 0.5, column + 0.5, height, width)
            red, green, blue = (
                radiance[row, column, 0] * angles[row],
                radiance[row, column, 1] * angles[row],
                radiance[row, column, 2] * angles[row],
            )
            for i in range(len(normal)):
                nol = normal[i, 0] * lx + normal[i, 1] * ly + normal[i, 2] * lz
                if nol <= 0.0:
                    continue
                vol = view[i, 0] * lx + view[i, 1] * ly + view[i, 2] * lz
                x = fresnel_weight(math.sqrt(max(0.5 + 0.5 * vol, 0.0)))
                lobe = (1.0 - f0) * (1.0 - x) * nol / math.pi
                result[i, 0] += lobe * red
                result[i, 1] += lobe * green
                result[i, 2] += lobe * blue


@inlined
def _specular_lobe(
    normal: Doubles, view: Doubles, i: int, lx: float, ly: float, lz: float, alpha: float, f0: float
) -> float:
    """F V D N.L of one direction of light."""
    nx, ny, nz = normal[i, 0], normal[i, 1], normal[i, 2]
    vx, vy, vz = view[i, 0], view[i, 1], view[i, 2]
    nol = nx * lx + ny * ly + nz * lz
    if nol <= 0.0:
        return 0.0
    hx, hy, hz = lx + vx, ly + vy, lz + vz
    scale = 1.0 / math.sqrt(max(hx * hx + hy * hy + hz * hz, 1e-18))
    hx, hy, hz = hx * scale, hy * scale, hz * scale
    # The squared sine by the cross product: 1 - N.H^2 has no digits left for narrow lobes
    cx, cy, cz = ny * hz - nz * hy, nz * hx - nx * hz, nx * hy - ny * hx
    density = ggx_density(cx * cx + cy * cy + cz * cz, alpha)
    visibility = smith_visibility(nol, nx * vx + ny * vy + nz * vz, alpha)
    fresnel = f0 + (1.0 - f0) * fresnel_weight(hx * vx + hy * vy + hz * vz)
    lobe: float = fresnel * density * visibility * nol
    return lobe


@kernel
def integrate_specular(
    radiance: Floats,
    angles: Doubles,
    normal: Doubles,
    view: Doubles,
    alpha: float,
    f0: float,
    result: Doubles,
) -> None:
    """Add the specular lobe's integral to `result` (N, 3)."""
    height, width = radiance.shape[0], radiance.shape[1]
    near = math.cos(NEAR_RAD)
    for i in range(len(normal)):
        nov = normal[i, 0] * view[i, 0] + normal[i, 1] * view[i, 1] + normal[i, 2] * view[i, 2]
        rx = 2.0 * nov * normal[i, 0] - view[i, 0]
        ry = 2.0 * nov * normal[i, 1] - view[i, 1]
        rz = 2.0 * nov * normal[i, 2] - view[i, 2]
        for row in range(height):
            for column in range(width):
                lx, ly, lz = _direction(row + 0.5, column + 0.5, height, width)
                if lx * rx + ly * ry + lz * rz < near:
                    lobe = _specular_lobe(normal, view, i, lx, ly, lz, alpha, f0)
                else:
                    lobe = 0.0
                    for a in range(CUT):
                        for b in range(CUT):
                            lx, ly, lz = _direction(
                                row + (a + 0.5) / CUT, column + (b + 0.5) / CUT, height, width
                            )
                            lobe += _specular_lobe(normal, view, i, lx, ly, lz, alpha, f0)
                    lobe /= CUT * CUT
                lobe *= angles[row]
                for c in range(3):
                    result[i, c] += lobe * radiance[row, column, c]


@kernel
def integrate_phong(
    radiance: Floats, angles: Doubles, towards: Doubles, exponent: float, result: Doubles
) -> None:
    """Write the means under cos^exponent to `result` (N, 3)."""
    height, width = radiance.shape[0], radiance.shape[1]
    total = np.zeros(len(towards))
    for row in range(height):
        for column in range(width):
            x, y, z = _direction(row + 0.5, column + 0.5, height, width)
            for i in range(len(towards)):
                cosine = towards[i, 0] * x + towards[i, 1] * y + towards[i, 2] * z
                if cosine <= 0.0:
                    continue
                weight = cosine**exponent * angles[row]
                total[i] += weight
                for c in range(3):
                    result[i, c] += weight * radiance[row, column, c]
    for i in range(len(towards)):
        for c in range(3):
            result[i, c] /= total[i]
