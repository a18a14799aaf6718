"""From "this point of that triangle" to how it is brushed."""

from raysvc.geometry.basis_kernels import basis
from raysvc.geometry.vector_kernels import Vec3, dot, plus, scaled, unit_or
from raysvc.jit import inlined
from raysvc.shading.attribute_kernels import Geometry
from raysvc.shading.brushed import Brushed
from raysvc.shading.material_table import (
    BRUSHING,
    BRUSHING_SLOT,
    BRUSHING_TURN,
    NORMAL_SLOT,
    MaterialTable,
)
from raysvc.shading.normal_map_kernels import tangent_frame
from raysvc.types import Doubles

LEAST_ROUGHNESS = 0.032
"""Of what is brushed: just rough enough not to be taken for a mirror, with GGX's least alpha."""


@inlined
def write_brushed(
    geometry: Geometry,
    materials: MaterialTable,
    texel: Doubles,
    triangle: int,
    u: float,
    v: float,
    front: Vec3,
    normal: Vec3,
    brushed: Brushed,
    n: int,
) -> None:
    """Write row n of a `Brushed`: a point at weights u, v of a triangle.

    texel (SLOTS, 4) is what the slots of its material read; `front` is the interpolated normal of
    the triangle's front, `normal` the shading normal on the viewer's side. The strength is 0 where
    neither tangents nor texture coordinates give a direction, or the texture gives none.
    """
    material = geometry.material_of_triangle[triangle]
    strength = materials.factors[material, BRUSHING]
    brushed.strength[n] = 0.0
    across, _ = basis(normal)
    for k in range(3):
        brushed.tangent[n, k] = across[k]
    if strength <= 0.0:
        return
    x, y = 1.0, 0.0
    if materials.texture[material, BRUSHING_SLOT, 0] >= 0:
        x, y = 2.0 * texel[BRUSHING_SLOT, 0] - 1.0, 2.0 * texel[BRUSHING_SLOT, 1] - 1.0
        strength *= texel[BRUSHING_SLOT, 2]
    cosine = materials.factors[material, BRUSHING_TURN]
    sine = materials.factors[material, BRUSHING_TURN + 1]
    x, y = cosine * x - sine * y, sine * x + cosine * y
    # The frame is that of the normal map, if there is one
    slot = BRUSHING_SLOT if materials.texture[material, NORMAL_SLOT, 0] < 0 else NORMAL_SLOT
    tangent, bitangent = tangent_frame(geometry, materials, slot, triangle, u, v, front)
    along = plus(scaled(tangent, x), bitangent, y)
    along = unit_or(plus(along, normal, -dot(along, normal)), (0.0, 0.0, 0.0))
    if dot(along, along) == 0.0:
        return
    brushed.strength[n] = min(max(strength, 0.0), 1.0)
    for k in range(3):
        brushed.tangent[n, k] = along[k]
