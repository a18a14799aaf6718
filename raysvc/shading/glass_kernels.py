"""From "that triangle, seen from there" to what rays through it need to know."""

from raysvc.geometry.vector_kernels import dot, row3, scaled
from raysvc.jit import kernel
from raysvc.shading.attribute_kernels import Geometry, normals
from raysvc.shading.glass import Glass
from raysvc.shading.material_table import ABSORPTION, IOR, MaterialTable
from raysvc.types import Floats, Ints


@kernel
def evaluate_glass(
    geometry: Geometry,
    materials: MaterialTable,
    triangle: Ints,
    directions: Floats,
    glass: Glass,
) -> None:
    """Fill the arrays of a `Glass` of N points, of triangles (N,) that rays (N, 3) arrive at."""
    for n in range(len(triangle)):
        material = geometry.material_of_triangle[triangle[n]]
        towards = scaled(row3(directions, n), -1.0)
        front, _ = normals(geometry, triangle[n], 0.0, 0.0, towards)
        glass.entering[n] = dot(front, towards) >= 0.0
        glass.solid[n] = materials.flags[material, 2] == 1
        glass.ior[n] = materials.factors[material, IOR]
        for k in range(3):
            glass.absorption[n, k] = materials.factors[material, ABSORPTION + k]
