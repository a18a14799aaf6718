"""How much of a point is there: masks, blends, and backs that are not seen."""

import numpy as np

from raysvc.geometry.vector_kernels import cross, dot, plus, row3
from raysvc.jit import inlined, kernel
from raysvc.shading.attribute_kernels import Geometry
from raysvc.shading.material_table import (
    ALPHA,
    BASE,
    BASE_SLOT,
    CUTOFF,
    F0,
    MASK,
    METALLIC,
    OPAQUE,
    TRANSMISSION,
    TRANSMISSION_SLOT,
    MaterialTable,
)
from raysvc.shading.slot_kernels import slot_uv
from raysvc.shading.texel_kernels import COLOUR, DATA, TextureTable
from raysvc.shading.texture_kernels import bilinear
from raysvc.types import Bools, Floats, Ints


@inlined
def alpha_of(
    geometry: Geometry,
    materials: MaterialTable,
    textures: TextureTable,
    triangle: int,
    u: float,
    v: float,
) -> float:
    """Coverage of a point as rays see it: 0 or 1 for masks, full-size texture alpha for blends."""
    material = geometry.material_of_triangle[triangle]
    mode = materials.flags[material, 0]
    if mode == OPAQUE:
        return 1.0
    weights = (1.0 - u - v, u, v)
    texel_alpha = 1.0
    if materials.texture[material, BASE_SLOT, 0] >= 0:
        uv = slot_uv(geometry, materials, material, BASE_SLOT, triangle, weights, 1.0)
        texture = materials.texture[material, BASE_SLOT, 0]
        texel_alpha = bilinear(textures, texture, uv, COLOUR)[3]
    i0, i1, i2 = (
        geometry.triangles[triangle, 0],
        geometry.triangles[triangle, 1],
        geometry.triangles[triangle, 2],
    )
    colour = geometry.colours
    vertex = weights[0] * colour[i0, 3] + u * colour[i1, 3] + v * colour[i2, 3]
    alpha = float(materials.factors[material, ALPHA] * texel_alpha * vertex)
    if mode == MASK:
        return 1.0 if alpha >= materials.factors[material, CUTOFF] else 0.0
    return min(max(alpha, 0.0), 1.0)


@inlined
def opacity_of(
    geometry: Geometry,
    materials: MaterialTable,
    textures: TextureTable,
    triangle: int,
    u: float,
    v: float,
) -> float:
    """Part of the light that a point keeps from what is behind it: coverage, but little for glass.

    Light goes straight through, as if a solid were a sheet, with the luminance of the glass: where
    a real one would gather light it is spread evenly.
    """
    opacity = alpha_of(geometry, materials, textures, triangle, u, v)
    material = geometry.material_of_triangle[triangle]
    factors = materials.factors
    through = float(factors[material, TRANSMISSION])
    if through == 0.0 or opacity == 0.0:
        return opacity
    weights = (1.0 - u - v, u, v)
    texture = materials.texture[material, TRANSMISSION_SLOT, 0]
    if texture >= 0:
        uv = slot_uv(geometry, materials, material, TRANSMISSION_SLOT, triangle, weights, 1.0)
        through *= bilinear(textures, texture, uv, DATA)[0]
    red, green, blue = 1.0, 1.0, 1.0
    texture = materials.texture[material, BASE_SLOT, 0]
    if texture >= 0:
        uv = slot_uv(geometry, materials, material, BASE_SLOT, triangle, weights, 1.0)
        red, green, blue, _ = bilinear(textures, texture, uv, COLOUR)
    red *= factors[material, BASE]
    green *= factors[material, BASE + 1]
    blue *= factors[material, BASE + 2]
    through *= (0.2126 * red + 0.7152 * green + 0.0722 * blue) * (1.0 - factors[material, F0])
    kept: float = opacity * (1.0 - through * (1.0 - factors[material, METALLIC]))
    return kept


@kernel
def opacities(
    geometry: Geometry,
    materials: MaterialTable,
    textures: TextureTable,
    triangle: Ints,
    barycentric: Floats,
    opacity: Floats,
) -> None:
    """Fill opacity (N,) of points at triangle (N,) and barycentric (N, 2); 0 where it is -1."""
    for n in range(len(triangle)):
        opacity[n] = 0.0
        if triangle[n] >= 0:
            u, v = np.float64(barycentric[n, 0]), np.float64(barycentric[n, 1])
            opacity[n] = opacity_of(geometry, materials, textures, triangle[n], u, v)


@kernel
def alphas(
    geometry: Geometry,
    materials: MaterialTable,
    textures: TextureTable,
    triangle: Ints,
    barycentric: Floats,
    alpha: Floats,
) -> None:
    """Fill alpha (N,) of points at triangle (N,) and barycentric (N, 2); 0 where it is -1."""
    for n in range(len(triangle)):
        alpha[n] = 0.0
        if triangle[n] >= 0:
            u, v = np.float64(barycentric[n, 0]), np.float64(barycentric[n, 1])
            alpha[n] = alpha_of(geometry, materials, textures, triangle[n], u, v)


@kernel
def coverages(
    geometry: Geometry,
    materials: MaterialTable,
    textures: TextureTable,
    double_sided: Bools,
    triangle: Ints,
    barycentric: Floats,
    directions: Floats,
    coverage: Floats,
) -> None:
    """Fill coverage (N,): alpha, but 0 where a ray sees the back of a single-sided triangle."""
    for n in range(len(triangle)):
        coverage[n] = 0.0
        f = triangle[n]
        if f < 0:
            continue
        if not double_sided[f]:
            a = row3(geometry.positions, geometry.triangles[f, 0])
            e1 = plus(row3(geometry.positions, geometry.triangles[f, 1]), a, -1.0)
            e2 = plus(row3(geometry.positions, geometry.triangles[f, 2]), a, -1.0)
            if dot(cross(e1, e2), row3(directions, n)) > 0.0:
                continue
        coverage[n] = alpha_of(
            geometry, materials, textures, f, barycentric[n, 0], barycentric[n, 1]
        )
