"""A scene as shading reads it: tables of geometry, materials and textures; surfaces from them."""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from raysvc.scene import Scene
from raysvc.shading.attribute_kernels import Geometry, positions_at
from raysvc.shading.coverage_kernels import alphas, coverages, opacities
from raysvc.shading.footprint import Footprint
from raysvc.shading.glass_kernels import evaluate_glass
from raysvc.shading.material_table import MaterialTable, material_table
from raysvc.shading.surface import Surface
from raysvc.shading.surface_kernels import evaluate
from raysvc.shading.texel_kernels import TextureTable
from raysvc.shading.texture_kernels import BILINEAR, EWA, MIP, NEAREST, SAT
from raysvc.shading.texture_sums import NO_SUMS, LazySums
from raysvc.shading.texture_table import texture_table
from raysvc.types import Bools, Floats, Ints

TEXTURE_FILTERS: Final = {
    "ewa": EWA,
    "mip": MIP,
    "sat": SAT,
    "bilinear": BILINEAR,
    "nearest": NEAREST,
}


@dataclass(frozen=True, slots=True, eq=False)
class SceneTables:
    """Everything that shading needs of a scene; made once, read by many threads."""

    geometry: Geometry
    materials: MaterialTable
    textures: TextureTable
    sums: LazySums
    """Summed-area tables of the textures, for the filter `sat`."""
    solid: Bools
    """(F,) bool: triangles without holes, that is whose material is opaque."""
    double_sided: Bools
    """(F,) bool: seen from both sides, as boundaries of solids always are."""
    blended: Bools
    """(F,) bool: of a material that is blended with what is behind it."""
    clear: Bools
    """(F,) bool: of a material that transmits light."""
    coated: bool
    """Some material has varnish: surfaces have a `Coat`."""
    glassy: bool
    """Some material transmits light: surfaces have a `Glass`."""
    brushed: bool
    """Some material is anisotropic: surfaces have a `Brushed`."""

    @classmethod
    def of(cls, scene: Scene) -> "SceneTables":
        """Build the tables of a scene."""
        modes = np.array([m.alpha_mode for m in scene.materials] or ["opaque"])
        double = np.array([m.double_sided or m.solid for m in scene.materials] or [True])
        material = scene.material_of_triangle
        materials, textures = material_table(scene.materials), texture_table(scene)
        return cls(
            Geometry(
                scene.positions,
                scene.normals,
                scene.tangents,
                scene.uv,
                scene.colours,
                scene.triangles,
                material,
            ),
            materials,
            textures,
            LazySums(materials, textures),
            (modes == "opaque")[material],
            double[material],
            (modes == "blend")[material],
            np.array([m.transmission > 0.0 for m in scene.materials] or [False])[material],
            any(m.clearcoat > 0.0 for m in scene.materials),
            any(m.transmission > 0.0 for m in scene.materials),
            any(m.anisotropy > 0.0 for m in scene.materials),
        )

    def of_shape(self, scene: Scene) -> "SceneTables":
        """Return the tables of another shape of the scene, with the same materials and textures."""
        geometry = self.geometry._replace(
            positions=scene.positions, normals=scene.normals, tangents=scene.tangents
        )
        return replace(self, geometry=geometry)

    def position(self, triangle: Ints, barycentric: Floats) -> Floats:
        """(N, 3) float32 of points; triangle (N,) is nowhere -1."""
        position = np.empty((len(triangle), 3), np.float32)
        positions_at(self.geometry, triangle, barycentric, position)
        return position

    def alpha(self, triangle: Ints, barycentric: Floats) -> Floats:
        """(N,) float32 coverage of points, 0 where triangle is -1; masks are 0 or 1."""
        alpha = np.empty(len(triangle), np.float32)
        alphas(self.geometry, self.materials, self.textures, triangle, barycentric, alpha)
        return alpha

    def opacity(self, triangle: Ints, barycentric: Floats) -> Floats:
        """(N,) float32: as `alpha`, but little for glass, which lets light through."""
        opacity = np.empty(len(triangle), np.float32)
        opacities(self.geometry, self.materials, self.textures, triangle, barycentric, opacity)
        return opacity

    def coverage(self, triangle: Ints, barycentric: Floats, directions: Floats) -> Floats:
        """(N,) alpha of points that rays (N, 3) see: 0 where they see a single-sided back."""
        coverage = np.empty(len(triangle), np.float32)
        coverages(
            self.geometry,
            self.materials,
            self.textures,
            self.double_sided,
            triangle,
            barycentric,
            directions,
            coverage,
        )
        return coverage

    def surface(
        self,
        triangle: Ints,
        barycentric: Floats,
        directions: Floats,
        footprint: Footprint | None = None,
        texture_filter: str = "bilinear",
    ) -> Surface:
        """Evaluate N points.

        Parameters
        ----------
        triangle
            (N,) int32, all >= 0
        barycentric
            (N, 2) weights of vertices 1 and 2
        directions
            (N, 3) unit directions of the rays that arrived
        footprint
            of N points, what pixels cover there; None for points without extent
        texture_filter
            a key of TEXTURE_FILTERS
        """
        surface = Surface.empty(len(triangle), self.coated, self.glassy, self.brushed)
        if footprint is None:
            footprint = Footprint.points(len(triangle))
        evaluate(
            self.geometry,
            self.materials,
            self.textures,
            self.sums.made() if texture_filter == "sat" else NO_SUMS,
            triangle,
            barycentric,
            directions,
            footprint,
            TEXTURE_FILTERS[texture_filter],
            surface,
        )
        if self.glassy:
            evaluate_glass(self.geometry, self.materials, triangle, directions, surface.glass)
        return surface
