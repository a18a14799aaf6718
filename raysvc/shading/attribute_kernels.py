"""What a triangle's vertices and textures say at a point of it."""

import math
from typing import NamedTuple

from raysvc.geometry.vector_kernels import Vec3, cross, dot, plus, row3, scaled, unit_or
from raysvc.jit import inlined
from raysvc.shading.material_table import (
    BASE_SLOT,
    EMISSIVE_SLOT,
    MaterialTable,
)
from raysvc.shading.texture_kernels import TextureTable, sample
from raysvc.types import Floats, Ints

Vec2 = tuple[float, float]
Vec4 = tuple[float, float, float, float]
LEAST_COSINE = 1e-3
"""A shading normal is bent until the viewer is at least this far above its horizon."""


class Geometry(NamedTuple):
    """The arrays of a `Scene` that kernels read."""

    positions: Floats
    normals: Floats
    tangents: Floats
    uv: Floats
    colours: Floats
    triangles: Ints
    material_of_triangle: Ints


@inlined
def mixed3(array: Floats, i0: int, i1: int, i2: int, u: float, v: float) -> Vec3:
    """Rows of an (N, >= 3) array mixed with barycentric weights."""
    w = 1.0 - u - v
    return (
        w * array[i0, 0] + u * array[i1, 0] + v * array[i2, 0],
        w * array[i0, 1] + u * array[i1, 1] + v * array[i2, 1],
        w * array[i0, 2] + u * array[i1, 2] + v * array[i2, 2],
    )


@inlined
def normals(
    geometry: Geometry, triangle: int, u: float, v: float, towards: Vec3
) -> tuple[Vec3, Vec3, float]:
    """Normal of a triangle and interpolated normal at a point, both of its front; twice its area.

    Where a triangle has no normal it is `towards`.
    """
    i0, i1, i2 = (
        geometry.triangles[triangle, 0],
        geometry.triangles[triangle, 1],
        geometry.triangles[triangle, 2],
    )
    a = row3(geometry.positions, i0)
    across = cross(
        plus(row3(geometry.positions, i1), a, -1.0), plus(row3(geometry.positions, i2), a, -1.0)
    )
    geometric = unit_or(across, towards)
    shading = unit_or(mixed3(geometry.normals, i0, i1, i2, u, v), geometric)
    if dot(shading, geometric) < 0.0:
        shading = scaled(shading, -1.0)
    return geometric, shading, math.sqrt(dot(across, across))


@inlined
def bumped(
    geometry: Geometry,
    materials: MaterialTable,
    textures: TextureTable,
    slot: int,
    scale_column: int,
    triangle: int,
    weights: Vec3,
    metres: float,
    texture_filter: int,
    normal: Vec3,
) -> Vec3:
    """Interpolated normal with the normal map of a slot, if there is one; see `read_slot`."""
    material = geometry.material_of_triangle[triangle]
    if materials.texture[material, slot, 0] < 0:
        return normal
    texel = read_slot(
        geometry,
        materials,
        textures,
        material,
        slot,
        triangle,
        weights,
        metres,
        texture_filter,
    )
    tangent, bitangent = tangent_frame(
        geometry, materials, slot, triangle, weights[1], weights[2], normal
    )
    scale = materials.factors[material, scale_column]
    x, y = (2.0 * texel[0] - 1.0) * scale, (2.0 * texel[1] - 1.0) * scale
    raised = scaled(normal, 2.0 * texel[2] - 1.0)
    return unit_or(plus(plus(raised, tangent, x), bitangent, y), normal)


@inlined
def turned_up(normal: Vec3, towards: Vec3) -> Vec3:
    """A shading normal bent until the viewer is at least LEAST_COSINE above its horizon."""
    above = dot(normal, towards)
    if above >= LEAST_COSINE:
        return normal
    return unit_or(plus(normal, towards, LEAST_COSINE - above), towards)


@inlined
def mixed_uv(uv: Floats, i0: int, i1: int, i2: int, uv_set: int, weights: Vec3) -> Vec2:
    """Texture coordinates of one set, mixed (or, with weights that sum to 0, differenced)."""
    return (
        weights[0] * uv[i0, uv_set, 0]
        + weights[1] * uv[i1, uv_set, 0]
        + weights[2] * uv[i2, uv_set, 0],
        weights[0] * uv[i0, uv_set, 1]
        + weights[1] * uv[i1, uv_set, 1]
        + weights[2] * uv[i2, uv_set, 1],
    )


@inlined
def transformed(matrices: Floats, material: int, slot: int, at: Vec2, offset: float) -> Vec2:
    """Affine transform of one slot, of a point (offset 1) or a difference (offset 0).

    Elements are read one by one: a view of the row would be counted as a reference, which costs
    more than the arithmetic. So it is in all of this file.
    """
    m = matrices
    return (
        m[material, slot, 0] * at[0] + m[material, slot, 1] * at[1] + offset * m[material, slot, 2],
        m[material, slot, 3] * at[0] + m[material, slot, 4] * at[1] + offset * m[material, slot, 5],
    )


@inlined
def read_slot(
    geometry: Geometry,
    materials: MaterialTable,
    textures: TextureTable,
    material: int,
    slot: int,
    triangle: int,
    weights: Vec3,
    metres: float,
    texture_filter: int,
) -> Vec4:
    """RGBA that a material's slot reads at a point, (1, 1, 1, 1) if it has no texture.

    `metres` is the footprint on the surface divided by the square root of the triangle's area in
    m^2 times two, so that the texture's area on the triangle turns it into texels.
    """
    texture = materials.texture[material, slot, 0]
    if texture < 0:
        return (1.0, 1.0, 1.0, 1.0)
    uv_set = materials.texture[material, slot, 1]
    matrix = materials.uv_transform
    i0, i1, i2 = (
        geometry.triangles[triangle, 0],
        geometry.triangles[triangle, 1],
        geometry.triangles[triangle, 2],
    )
    uv = transformed(
        matrix, material, slot, mixed_uv(geometry.uv, i0, i1, i2, uv_set, weights), 1.0
    )
    e1 = transformed(
        matrix, material, slot, mixed_uv(geometry.uv, i0, i1, i2, uv_set, (-1.0, 1.0, 0.0)), 0.0
    )
    e2 = transformed(
        matrix, material, slot, mixed_uv(geometry.uv, i0, i1, i2, uv_set, (-1.0, 0.0, 1.0)), 0.0
    )
    texels = float(textures.size[texture, 0, 0]) * float(textures.size[texture, 0, 1])
    texel_area = abs(e1[0] * e2[1] - e1[1] * e2[0]) * texels
    is_colour = slot in (BASE_SLOT, EMISSIVE_SLOT)
    return sample(textures, texture, uv, metres * math.sqrt(texel_area), texture_filter, is_colour)


@inlined
def tangent_frame(
    geometry: Geometry,
    materials: MaterialTable,
    slot: int,
    triangle: int,
    u: float,
    v: float,
    normal: Vec3,
) -> tuple[Vec3, Vec3]:
    """Tangent and bitangent for the normal map of a slot: the vertices', else those of the uv."""
    material = geometry.material_of_triangle[triangle]
    matrix, uv_set = materials.uv_transform, materials.texture[material, slot, 1]
    i0, i1, i2 = (
        geometry.triangles[triangle, 0],
        geometry.triangles[triangle, 1],
        geometry.triangles[triangle, 2],
    )
    handed = geometry.tangents[i0, 3]
    if handed != 0.0 and handed == geometry.tangents[i1, 3] == geometry.tangents[i2, 3]:
        tangent = mixed3(geometry.tangents, i0, i1, i2, u, v)
        tangent = unit_or(plus(tangent, normal, -dot(tangent, normal)), (0.0, 0.0, 0.0))
        return tangent, scaled(cross(normal, tangent), handed)
    a = row3(geometry.positions, i0)
    p1, p2 = (
        plus(row3(geometry.positions, i1), a, -1.0),
        plus(row3(geometry.positions, i2), a, -1.0),
    )
    e1 = transformed(
        matrix, material, slot, mixed_uv(geometry.uv, i0, i1, i2, uv_set, (-1.0, 1.0, 0.0)), 0.0
    )
    e2 = transformed(
        matrix, material, slot, mixed_uv(geometry.uv, i0, i1, i2, uv_set, (-1.0, 0.0, 1.0)), 0.0
    )
    area = e1[0] * e2[1] - e1[1] * e2[0]
    handed = 1.0 if area < 0.0 else -1.0
    # dp/du up to a positive factor; v grows downwards in the texture, glTF's bitangent upwards.
    sign = 1.0 if area > 0.0 else -1.0
    tangent = (
        sign * (e2[1] * p1[0] - e1[1] * p2[0]),
        sign * (e2[1] * p1[1] - e1[1] * p2[1]),
        sign * (e2[1] * p1[2] - e1[1] * p2[2]),
    )
    tangent = unit_or(plus(tangent, normal, -dot(tangent, normal)), (0.0, 0.0, 0.0))
    return tangent, scaled(cross(normal, tangent), handed)
