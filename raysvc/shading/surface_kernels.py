"""From "this point of that triangle" to a surface with its material evaluated."""

import numpy as np

from raysvc.geometry.vector_kernels import dot, row3, scaled
from raysvc.jit import kernel
from raysvc.shading.attribute_kernels import Geometry, mixed3, normals
from raysvc.shading.brushed_kernels import LEAST_ROUGHNESS, write_brushed
from raysvc.shading.coat_kernels import write_coat
from raysvc.shading.footprint import Footprint
from raysvc.shading.footprint_kernels import spread_of_weights
from raysvc.shading.material_table import (
    ALPHA,
    BASE,
    BASE_SLOT,
    BLEND,
    BRUSHING_SLOT,
    COAT_SLOT,
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
    SLOTS,
    TRANSMISSION,
    TRANSMISSION_SLOT,
    MaterialTable,
)
from raysvc.shading.normal_map_kernels import bumped, turned_up
from raysvc.shading.slot_kernels import read_slot
from raysvc.shading.surface import Surface
from raysvc.shading.texel_kernels import TextureTable
from raysvc.shading.texture_sum_kernels import TextureSums
from raysvc.types import Floats, Ints

CLEARANCE = 256 * 1.1920929e-07
"""Of a ray that leaves a triangle, as a part of its largest coordinate: 256 steps of float32."""


@kernel
def evaluate(
    geometry: Geometry,
    materials: MaterialTable,
    textures: TextureTable,
    sums: TextureSums,
    triangle: Ints,
    barycentric: Floats,
    directions: Floats,
    footprint: Footprint,
    texture_filter: int,
    surface: Surface,
) -> None:
    """Fill the arrays of a `Surface` of N points, those of coat and brushing if there is room.

    triangle (N,), barycentric (N, 2); directions (N, 3) unit, of the rays that arrived; footprint
    of N points, what pixels cover there.
    """
    is_coated = len(surface.coat.clearcoat) > 0
    is_brushed = len(surface.brushed.strength) > 0
    slots = SLOTS if is_brushed else (BRUSHING_SLOT if is_coated else COAT_SLOT)
    texel = np.empty((SLOTS, 4))
    for n in range(len(triangle)):
        f = triangle[n]
        u, v = np.float64(barycentric[n, 0]), np.float64(barycentric[n, 1])
        weights = (1.0 - u - v, u, v)
        i0, i1, i2 = geometry.triangles[f, 0], geometry.triangles[f, 1], geometry.triangles[f, 2]
        material = geometry.material_of_triangle[f]
        factors = materials.factors
        arriving = row3(directions, n)
        towards = scaled(arriving, -1.0)

        # What every slot reads; in a loop, for each copy of the filters takes seconds to compile
        spread, is_known = (0.0, 0.0, 0.0), False
        for slot in range(slots):
            texel[slot, 0] = texel[slot, 1] = texel[slot, 2] = texel[slot, 3] = 1.0
            if materials.texture[material, slot, 0] < 0:
                continue
            if not is_known:
                is_known = True
                spread = spread_of_weights(
                    row3(geometry.positions, i0),
                    row3(geometry.positions, i1),
                    row3(geometry.positions, i2),
                    arriving,
                    row3(footprint.dpdx, n),
                    row3(footprint.dpdy, n),
                    np.float64(footprint.blur[n]),
                )
            texel[slot, 0], texel[slot, 1], texel[slot, 2], texel[slot, 3] = read_slot(
                geometry, materials, textures, sums, slot, f, weights, spread, texture_filter
            )

        # Geometric and shading normal, of the front with its normal map, then on the viewer's side
        ng, front = normals(geometry, f, u, v, towards)
        side = 1.0 if dot(ng, towards) >= 0.0 else -1.0
        read = (texel[NORMAL_SLOT, 0], texel[NORMAL_SLOT, 1], texel[NORMAL_SLOT, 2], 1.0)
        ns = bumped(geometry, materials, NORMAL_SLOT, NORMAL_SCALE, f, u, v, read, front)
        ng, ns = scaled(ng, side), turned_up(scaled(ns, side), towards)
        if is_coated:
            write_coat(geometry, materials, texel, f, u, v, front, side, towards, surface.coat, n)

        if is_brushed:
            write_brushed(geometry, materials, texel, f, u, v, front, ns, surface.brushed, n)

        # Colour and coverage
        colour = geometry.colours
        vertex = mixed3(colour, i0, i1, i2, u, v)
        surface.base_colour[n, 0] = factors[material, BASE] * texel[BASE_SLOT, 0] * vertex[0]
        surface.base_colour[n, 1] = factors[material, BASE + 1] * texel[BASE_SLOT, 1] * vertex[1]
        surface.base_colour[n, 2] = factors[material, BASE + 2] * texel[BASE_SLOT, 2] * vertex[2]
        surface.alpha[n] = 1.0
        if materials.flags[material, 0] == BLEND:
            vertex_alpha = weights[0] * colour[i0, 3] + u * colour[i1, 3] + v * colour[i2, 3]
            alpha = factors[material, ALPHA] * texel[BASE_SLOT, 3] * vertex_alpha
            surface.alpha[n] = min(max(alpha, 0.0), 1.0)

        # Metalness, roughness, transmission, occlusion, emission
        roughness = factors[material, ROUGHNESS] * texel[METALLIC_ROUGHNESS_SLOT, 1]
        surface.roughness[n] = min(max(roughness, 0.0), 1.0)
        if is_brushed and surface.brushed.strength[n] > 0.0:
            surface.roughness[n] = max(surface.roughness[n], LEAST_ROUGHNESS)
        metallic = factors[material, METALLIC] * texel[METALLIC_ROUGHNESS_SLOT, 2]
        surface.metallic[n] = min(max(metallic, 0.0), 1.0)
        surface.dielectric_f0[n] = factors[material, F0]
        surface.transmission[n] = factors[material, TRANSMISSION] * texel[TRANSMISSION_SLOT, 0]
        darker = factors[material, OCCLUSION_STRENGTH] * (texel[OCCLUSION_SLOT, 0] - 1.0)
        surface.occlusion[n] = 1.0 + darker
        for k in range(3):
            surface.emissive[n, k] = factors[material, EMISSIVE + k] * texel[EMISSIVE_SLOT, k]
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
