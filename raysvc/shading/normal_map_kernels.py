"""Normal maps: shading normals bent by the texture of a slot."""

from raysvc.geometry.vector_kernels import Vec3, cross, dot, plus, row3, scaled, unit_or
from raysvc.jit import inlined
from raysvc.shading.attribute_kernels import Geometry, mixed3
from raysvc.shading.material_table import MaterialTable
from raysvc.shading.slot_kernels import slot_edges
from raysvc.shading.texel_kernels import Vec4

LEAST_COSINE = 1e-3
"""A shading normal is bent until the viewer is at least this far above its horizon."""


@inlined
def bumped(
    geometry: Geometry,
    materials: MaterialTable,
    slot: int,
    scale_column: int,
    triangle: int,
    u: float,
    v: float,
    texel: Vec4,
    normal: Vec3,
) -> Vec3:
    """Interpolated normal with the normal map of a slot, of which `texel` was read, if it has one.

    `scale_column` is that of the map's scale in `MaterialTable.factors`.
    """
    material = geometry.material_of_triangle[triangle]
    if materials.texture[material, slot, 0] < 0:
        return normal
    tangent, bitangent = tangent_frame(geometry, materials, slot, triangle, u, v, normal)
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
    e1, e2 = slot_edges(geometry, materials, material, slot, triangle)
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
