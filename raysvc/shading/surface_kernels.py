"""From "this point of that triangle" to a surface with its material evaluated."""

import math

import numpy as np

from raysvc.geometry.vector_kernels import cross, dot, plus, row3, scaled, unit_or
from raysvc.jit import kernel
from raysvc.shading.attribute_kernels import Geometry, mixed3, read_slot, tangent_frame
from raysvc.shading.material_table import (
    ALPHA,
    BASE,
    BASE_SLOT,
    BLEND,
    EMISSIVE,
    EMISSIVE_SLOT,
    F0,
    METALLIC,
    METALLIC_ROUGHNESS_SLOT,
    NORMAL_SCALE,
    NORMAL_SLOT,
    OCCLUSION_SLOT,
    OCCLUSION_STRENGTH,
    ROUGHNESS,
    MaterialTable,
)
from raysvc.shading.surface import Surface
from raysvc.shading.texture_kernels import TextureTable
from raysvc.types import Floats, Ints

CLEARANCE = 256 * 1.1920929e-07
"""Of a ray that leaves a triangle, as a part of its largest coordinate: 256 steps of float32."""
LEAST_COSINE = 1e-3
"""A shading normal is bent until the viewer is at least this far above its horizon."""


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
    surface: Surface,
) -> None:
    """Fill the arrays of a `Surface` of N points.

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
        surface.base_colour[n, 0] = factors[material, BASE] * texel[0] * vertex[0]
        surface.base_colour[n, 1] = factors[material, BASE + 1] * texel[1] * vertex[1]
        surface.base_colour[n, 2] = factors[material, BASE + 2] * texel[2] * vertex[2]
        surface.alpha[n] = 1.0
        if materials.flags[material, 0] == BLEND:
            vertex_alpha = weights[0] * colour[i0, 3] + u * colour[i1, 3] + v * colour[i2, 3]
            surface.alpha[n] = min(
                max(factors[material, ALPHA] * texel[3] * vertex_alpha, 0.0), 1.0
            )

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
        surface.roughness[n] = min(max(factors[material, ROUGHNESS] * texel[1], 0.0), 1.0)
        surface.metallic[n] = min(max(factors[material, METALLIC] * texel[2], 0.0), 1.0)
        surface.dielectric_f0[n] = factors[material, F0]
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
        surface.occlusion[n] = 1.0 + factors[material, OCCLUSION_STRENGTH] * (texel[0] - 1.0)
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
        surface.emissive[n, 0] = factors[material, EMISSIVE] * texel[0]
        surface.emissive[n, 1] = factors[material, EMISSIVE + 1] * texel[1]
        surface.emissive[n, 2] = factors[material, EMISSIVE + 2] * texel[2]
        surface.unlit[n] = materials.flags[material, 1] == 1

        largest = 0.0
        for k in range(3):
            largest = max(largest, abs(geometry.positions[i0, k]))
            largest = max(largest, abs(geometry.positions[i1, k]))
            largest = max(largest, abs(geometry.positions[i2, k]))
        surface.clearance[n] = CLEARANCE * largest
        point = mixed3(geometry.positions, i0, i1, i2, u, v)
        for k in range(3):
            surface.position[n, k] = point[k]
            surface.geometric_normal[n, k] = ng[k]
            surface.normal[n, k] = ns[k]
            surface.to_viewer[n, k] = towards[k]
