"""What the textures of a material's slots say at a point of a triangle."""

from raysvc.geometry.vector_kernels import Vec3
from raysvc.jit import inlined
from raysvc.shading.attribute_kernels import Geometry, mixed_uv
from raysvc.shading.ellipse_kernels import Spread, turned_into
from raysvc.shading.material_table import BASE_SLOT, EMISSIVE_SLOT, MaterialTable
from raysvc.shading.texel_kernels import COLOUR, DATA, TextureTable, Vec2, Vec4
from raysvc.shading.texture_kernels import filtered
from raysvc.shading.texture_sum_kernels import TextureSums
from raysvc.types import Floats


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
def slot_uv(
    geometry: Geometry,
    materials: MaterialTable,
    material: int,
    slot: int,
    triangle: int,
    weights: Vec3,
    offset: float,
) -> Vec2:
    """Where a slot's texture is read at a point, or how far apart two points are in it (offset 0).

    In units of uv after the slot's transform; for differences the weights sum to 0.
    """
    i0, i1, i2 = (
        geometry.triangles[triangle, 0],
        geometry.triangles[triangle, 1],
        geometry.triangles[triangle, 2],
    )
    uv_set = materials.texture[material, slot, 1]
    at = mixed_uv(geometry.uv, i0, i1, i2, uv_set, weights)
    return transformed(materials.uv_transform, material, slot, at, offset)


@inlined
def slot_edges(
    geometry: Geometry, materials: MaterialTable, material: int, slot: int, triangle: int
) -> tuple[Vec2, Vec2]:
    """Edges of a triangle in a slot's texture: what the weights of vertices 1 and 2 add."""
    return (
        slot_uv(geometry, materials, material, slot, triangle, (-1.0, 1.0, 0.0), 0.0),
        slot_uv(geometry, materials, material, slot, triangle, (-1.0, 0.0, 1.0), 0.0),
    )


@inlined
def read_slot(
    geometry: Geometry,
    materials: MaterialTable,
    textures: TextureTable,
    sums: TextureSums,
    slot: int,
    triangle: int,
    weights: Vec3,
    spread: Spread,
    texture_filter: int,
) -> Vec4:
    """RGBA that a material's slot, which must have a texture, reads over what a pixel covers.

    `spread` is the pixel's matrix in the weights of vertices 1 and 2.
    """
    material = geometry.material_of_triangle[triangle]
    uv = slot_uv(geometry, materials, material, slot, triangle, weights, 1.0)
    e1, e2 = slot_edges(geometry, materials, material, slot, triangle)
    covered = turned_into(spread, (e1[0], e2[0]), (e1[1], e2[1]))
    kind = COLOUR if slot == BASE_SLOT or slot == EMISSIVE_SLOT else DATA
    texture = materials.texture[material, slot, 0]
    return filtered(textures, sums, texture, uv, covered, texture_filter, kind)
