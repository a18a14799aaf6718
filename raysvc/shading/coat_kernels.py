"""From "this point of that triangle" to the varnish on it."""

from raysvc.geometry.vector_kernels import Vec3, scaled
from raysvc.jit import inlined
from raysvc.shading.attribute_kernels import Geometry
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
from raysvc.shading.normal_map_kernels import bumped, turned_up
from raysvc.types import Doubles


@inlined
def write_coat(
    geometry: Geometry,
    materials: MaterialTable,
    texel: Doubles,
    triangle: int,
    u: float,
    v: float,
    front: Vec3,
    side: float,
    towards: Vec3,
    coat: Coat,
    n: int,
) -> None:
    """Write row n of a `Coat`: a point at weights u, v of a triangle.

    texel (SLOTS, 4) is what the slots of its material read; `front` is the interpolated normal of
    the triangle's front, `side` 1 or -1 for the side that is seen, and `towards` its viewer.
    """
    material = geometry.material_of_triangle[triangle]
    coat.clearcoat[n] = materials.factors[material, COAT] * texel[COAT_SLOT, 0]
    coat.roughness[n] = materials.factors[material, COAT_ROUGHNESS] * texel[COAT_ROUGHNESS_SLOT, 1]
    slot = COAT_NORMAL_SLOT
    read = (texel[slot, 0], texel[slot, 1], texel[slot, 2], 1.0)
    normal = bumped(geometry, materials, slot, COAT_NORMAL_SCALE, triangle, u, v, read, front)
    normal = turned_up(scaled(normal, side), towards)
    for k in range(3):
        coat.normal[n, k] = normal[k]
