"""From "this point of that triangle" to a surface with its material evaluated."""

import math

import numpy as np

from raysvc.geometry.vector_kernels import dot, scaled
from raysvc.jit import kernel
from raysvc.shading.attribute_kernels import (
    Geometry,
    bumped,
    mixed3,
    normals,
    read_slot,
    turned_up,
)
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
    TRANSMISSION,
    TRANSMISSION_SLOT,
    MaterialTable,
)
from raysvc.shading.surface import Surface
from raysvc.shading.texture_kernels import TextureTable
from raysvc.types import Floats, Ints

CLEARANCE = 256 * 1.1920929e-07
"""Of a ray that leaves a triangle, as a part of its largest coordinate: 256 steps of float32."""


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

        # Geometric and shading normal, of the front with its normal map, then on the viewer's side
        ng, ns, double_area = normals(geometry, f, u, v, towards)
        side = 1.0 if dot(ng, towards) >= 0.0 else -1.0
        cosine = max(abs(dot(ng, towards)), 0.02)
        metres = footprint[n] / math.sqrt(cosine * max(double_area, 1e-30))
        ns = bumped(
            geometry,
            materials,
            textures,
            NORMAL_SLOT,
            NORMAL_SCALE,
            f,
            weights,
            metres,
            texture_filter,
            ns,
        )
        ng, ns = scaled(ng, side), turned_up(scaled(ns, side), towards)

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
        surface.transmission[n] = factors[material, TRANSMISSION]
        if materials.texture[material, TRANSMISSION_SLOT, 0] >= 0:
            texel = read_slot(
                geometry,
                materials,
                textures,
                material,
                TRANSMISSION_SLOT,
                f,
                weights,
                metres,
                texture_filter,
            )
            surface.transmission[n] *= texel[0]
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
