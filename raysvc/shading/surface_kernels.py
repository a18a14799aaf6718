"""From "this point of that triangle" to a surface with its material, one point at a time."""

import math
from typing import NamedTuple

import numpy as np

from raysvc.jit import inlined, kernel
from raysvc.shading.material_table import (
    ALPHA,
    BASE,
    BASE_SLOT,
    BLEND,
    CUTOFF,
    EMISSIVE,
    EMISSIVE_SLOT,
    F0,
    MASK,
    METALLIC,
    METALLIC_ROUGHNESS_SLOT,
    NORMAL_SCALE,
    NORMAL_SLOT,
    OCCLUSION_SLOT,
    OCCLUSION_STRENGTH,
    OPAQUE,
    ROUGHNESS,
    MaterialTable,
)
from raysvc.shading.texture_kernels import BILINEAR, TextureTable, sample
from raysvc.types import Bools, Floats, Ints

Vec2 = tuple[float, float]
Vec3 = tuple[float, float, float]
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
def dot(a: Vec3, b: Vec3) -> float:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def cross(a: Vec3, b: Vec3) -> Vec3:
    """Vector product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@inlined
def scaled(a: Vec3, k: float) -> Vec3:
    """Vector times number."""
    return (a[0] * k, a[1] * k, a[2] * k)


@inlined
def plus(a: Vec3, b: Vec3, k: float) -> Vec3:
    """a + k b."""
    return (a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2])


@inlined
def unit_or(a: Vec3, other: Vec3) -> Vec3:
    """A vector scaled to length 1, or `other` where it is (nearly) zero."""
    length = math.sqrt(dot(a, a))
    return scaled(a, 1.0 / length) if length > 1e-20 else other


@inlined
def row3(array: Floats, row: int) -> Vec3:
    """Row of an (N, 3) array as doubles; Numba's float() would leave it single."""
    return (np.float64(array[row, 0]), np.float64(array[row, 1]), np.float64(array[row, 2]))


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
    triangle: int,
    u: float,
    v: float,
    normal: Vec3,
) -> tuple[Vec3, Vec3]:
    """Tangent and bitangent for a normal map: the vertices', else those of the triangle's uv."""
    material, slot = geometry.material_of_triangle[triangle], NORMAL_SLOT
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
    texel = read_slot(
        geometry, materials, textures, material, BASE_SLOT, triangle, weights, 0.0, BILINEAR
    )
    i0, i1, i2 = (
        geometry.triangles[triangle, 0],
        geometry.triangles[triangle, 1],
        geometry.triangles[triangle, 2],
    )
    colour = geometry.colours
    vertex = weights[0] * colour[i0, 3] + u * colour[i1, 3] + v * colour[i2, 3]
    alpha = float(materials.factors[material, ALPHA] * texel[3] * vertex)
    if mode == MASK:
        return 1.0 if alpha >= materials.factors[material, CUTOFF] else 0.0
    return min(max(alpha, 0.0), 1.0)


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
def evaluate(
    geometry: Geometry,
    materials: MaterialTable,
    textures: TextureTable,
    triangle: Ints,
    barycentric: Floats,
    directions: Floats,
    footprint: Floats,
    texture_filter: int,
    position: Floats,
    geometric_normal: Floats,
    normal: Floats,
    view: Floats,
    base_colour: Floats,
    alpha: Floats,
    metallic: Floats,
    roughness: Floats,
    dielectric_f0: Floats,
    emissive: Floats,
    occlusion: Floats,
    unlit: Bools,
) -> None:
    """Fill the arrays of a `Surface` for N points.

    triangle (N,), barycentric (N, 2); directions (N, 3) unit, of the rays that arrived; footprint
    (N,) width in metres of what a pixel sees there, across the ray.
    """
    for n in range(len(triangle)):
        f = triangle[n]
        u, v = np.float64(barycentric[n, 0]), np.float64(barycentric[n, 1])
        weights = (1.0 - u - v, u, v)
        i0, i1, i2 = geometry.triangles[f, 0], geometry.triangles[f, 1], geometry.triangles[f, 2]
        material = geometry.material_of_triangle[f]
        factors = materials.factors
        towards = (-float(directions[n, 0]), -float(directions[n, 1]), -float(directions[n, 2]))

        # Geometric and shading normal, both on the viewer's side
        a = row3(geometry.positions, i0)
        across = cross(
            plus(row3(geometry.positions, i1), a, -1.0), plus(row3(geometry.positions, i2), a, -1.0)
        )
        double_area = math.sqrt(dot(across, across))
        ng = unit_or(across, towards)
        ns = unit_or(mixed3(geometry.normals, i0, i1, i2, u, v), ng)
        side = 1.0 if dot(ng, towards) >= 0.0 else -1.0
        if dot(ns, ng) < 0.0:
            ns = scaled(ns, -1.0)
        cosine = max(abs(dot(ng, towards)), 0.02)
        metres = footprint[n] / math.sqrt(cosine * max(double_area, 1e-30))

        # Normal map, in the frame of the front side
        if materials.texture[material, NORMAL_SLOT, 0] >= 0:
            texel = read_slot(
                geometry,
                materials,
                textures,
                material,
                NORMAL_SLOT,
                f,
                weights,
                metres,
                texture_filter,
            )
            tangent, bitangent = tangent_frame(geometry, materials, f, u, v, ns)
            x = (2.0 * texel[0] - 1.0) * factors[material, NORMAL_SCALE]
            y = (2.0 * texel[1] - 1.0) * factors[material, NORMAL_SCALE]
            bumped = scaled(ns, 2.0 * texel[2] - 1.0)
            ns = unit_or(plus(plus(bumped, tangent, x), bitangent, y), ns)
        ng, ns = scaled(ng, side), scaled(ns, side)
        above = dot(ns, towards)
        if above < LEAST_COSINE:
            ns = unit_or(plus(ns, towards, LEAST_COSINE - above), towards)

        # Colour and coverage
        texel = read_slot(
            geometry, materials, textures, material, BASE_SLOT, f, weights, metres, texture_filter
        )
        colour = geometry.colours
        vertex = mixed3(colour, i0, i1, i2, u, v)
        base_colour[n, 0] = factors[material, BASE] * texel[0] * vertex[0]
        base_colour[n, 1] = factors[material, BASE + 1] * texel[1] * vertex[1]
        base_colour[n, 2] = factors[material, BASE + 2] * texel[2] * vertex[2]
        alpha[n] = 1.0
        if materials.flags[material, 0] == BLEND:
            vertex_alpha = weights[0] * colour[i0, 3] + u * colour[i1, 3] + v * colour[i2, 3]
            alpha[n] = min(max(factors[material, ALPHA] * texel[3] * vertex_alpha, 0.0), 1.0)

        # Metalness, roughness, occlusion, emission
        texel = read_slot(
            geometry,
            materials,
            textures,
            material,
            METALLIC_ROUGHNESS_SLOT,
            f,
            weights,
            metres,
            texture_filter,
        )
        roughness[n] = min(max(factors[material, ROUGHNESS] * texel[1], 0.0), 1.0)
        metallic[n] = min(max(factors[material, METALLIC] * texel[2], 0.0), 1.0)
        dielectric_f0[n] = factors[material, F0]
        texel = read_slot(
            geometry,
            materials,
            textures,
            material,
            OCCLUSION_SLOT,
            f,
            weights,
            metres,
            texture_filter,
        )
        occlusion[n] = 1.0 + factors[material, OCCLUSION_STRENGTH] * (texel[0] - 1.0)
        texel = read_slot(
            geometry,
            materials,
            textures,
            material,
            EMISSIVE_SLOT,
            f,
            weights,
            metres,
            texture_filter,
        )
        emissive[n, 0] = factors[material, EMISSIVE] * texel[0]
        emissive[n, 1] = factors[material, EMISSIVE + 1] * texel[1]
        emissive[n, 2] = factors[material, EMISSIVE + 2] * texel[2]
        unlit[n] = materials.flags[material, 1] == 1

        point = mixed3(geometry.positions, i0, i1, i2, u, v)
        for k in range(3):
            position[n, k] = point[k]
            geometric_normal[n, k] = ng[k]
            normal[n, k] = ns[k]
            view[n, k] = towards[k]
