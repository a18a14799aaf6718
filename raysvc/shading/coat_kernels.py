"""From "this point of that triangle" to the varnish on it."""

import math

import numpy as np

from raysvc.geometry.vector_kernels import dot, scaled
from raysvc.jit import kernel
from raysvc.shading.attribute_kernels import Geometry, bumped, normals, read_slot, turned_up
from raysvc.shading.coat import Coat
from raysvc.shading.material_table import (
    COAT,
    COAT_NORMAL_SCALE,
    COAT_NORMAL_SLOT,
    COAT_ROUGHNESS,
    COAT_ROUGHNESS_SLOT,
    COAT_SLOT,
    MaterialTable,
)
from raysvc.shading.texture_kernels import TextureTable
from raysvc.types import Floats, Ints


@kernel
def evaluate_coat(
    geometry: Geometry,
    materials: MaterialTable,
    textures: TextureTable,
    triangle: Ints,
    barycentric: Floats,
    directions: Floats,
    footprint: Floats,
    texture_filter: int,
    coat: Coat,
) -> None:
    """Fill the arrays of a `Coat` of N points; the arguments are those of `surface_kernels`."""
    for n in range(len(triangle)):
        f = triangle[n]
        u, v = np.float64(barycentric[n, 0]), np.float64(barycentric[n, 1])
        weights = (1.0 - u - v, u, v)
        material = geometry.material_of_triangle[f]
        towards = (-float(directions[n, 0]), -float(directions[n, 1]), -float(directions[n, 2]))
        ng, ns, double_area = normals(geometry, f, u, v, towards)
        facing = dot(ng, towards)
        clearcoat = materials.factors[material, COAT]
        roughness = materials.factors[material, COAT_ROUGHNESS]
        if clearcoat > 0.0:
            metres = footprint[n] / math.sqrt(max(abs(facing), 0.02) * max(double_area, 1e-30))
            texel = read_slot(
                geometry,
                materials,
                textures,
                material,
                COAT_SLOT,
                f,
                weights,
                metres,
                texture_filter,
            )
            clearcoat *= texel[0]
            texel = read_slot(
                geometry,
                materials,
                textures,
                material,
                COAT_ROUGHNESS_SLOT,
                f,
                weights,
                metres,
                texture_filter,
            )
            roughness *= texel[1]
            ns = bumped(
                geometry,
                materials,
                textures,
                COAT_NORMAL_SLOT,
                COAT_NORMAL_SCALE,
                f,
                weights,
                metres,
                texture_filter,
                ns,
            )
        ns = turned_up(scaled(ns, 1.0 if facing >= 0.0 else -1.0), towards)
        coat.clearcoat[n] = clearcoat
        coat.roughness[n] = roughness
        for k in range(3):
            coat.normal[n, k] = ns[k]
