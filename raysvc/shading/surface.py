"""N points of surfaces with everything that light needs to know about them."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from raysvc import records
from raysvc.shading.brushed import Brushed
from raysvc.shading.coat import Coat
from raysvc.shading.glass import Glass
from raysvc.shading.mirrored import Mirrored
from raysvc.shading.rescattering import Rescattering
from raysvc.types import Bools, Floats, Longs


class Surface(NamedTuple):
    """Points with materials evaluated; world space, linear Rec.709, float32 except `unlit`.

    A tuple of arrays, so that kernels take it whole. Few scenes have varnish, glass or brushed
    metal, so those are groups of arrays of their own: of all N points, or of none where no material
    of the scene asks for them. Arrays without rows cost nothing to make, to copy and to pass, and
    have the same type, so that no kernel is compiled twice.

    Attributes
    ----------
    position
        (N, 3)
    geometric_normal
        (N, 3) unit normal of the triangle, on the viewer's side
    normal
        (N, 3) unit shading normal with the normal map applied, on the viewer's side
    to_viewer
        (N, 3) unit, from the point towards whoever looks (camera, or the origin of a reflected ray)
    base_colour, alpha
        (N, 3), (N,)
    metallic, roughness
        (N,), (N,) in 0..1; GGX alpha is roughness squared
    dielectric_f0
        (N,) reflectance at normal incidence where it is not metal
    transmission
        (N,) 0..1 of the light that enters goes through, and the rest is diffused; what rays need to
        know of that is in `Glass`
    emissive
        (N, 3) radiance
    occlusion
        (N,) 0..1 from the material's occlusion texture, strength applied; for light from the
        environment only
    unlit
        (N,) bool: shows `base_colour` and nothing else
    clearance
        (N,) metres off the triangle at which a ray surely does not meet it
    coat
        of N points or none
    glass
        of N points or none
    brushed
        of N points or none
    mirrored
        of N points, or none where no picture is made of them
    rescattering
        of N points, or none where multiple scattering is left out
    """

    position: Floats
    geometric_normal: Floats
    normal: Floats
    to_viewer: Floats
    base_colour: Floats
    alpha: Floats
    metallic: Floats
    roughness: Floats
    dielectric_f0: Floats
    transmission: Floats
    emissive: Floats
    occlusion: Floats
    unlit: Bools
    clearance: Floats
    coat: Coat
    glass: Glass
    brushed: Brushed = Brushed.empty(0)
    mirrored: Mirrored = Mirrored.empty(0)
    rescattering: Rescattering = Rescattering.empty(0)

    @property
    def size(self) -> int:
        """Number of points."""
        return len(self.position)

    @staticmethod
    def empty(
        count: int, coated: bool = False, glassy: bool = False, brushed: bool = False
    ) -> "Surface":
        """Return room for points, to be filled, with or without those of the groups."""
        return Surface(
            position=np.empty((count, 3), np.float32),
            geometric_normal=np.empty((count, 3), np.float32),
            normal=np.empty((count, 3), np.float32),
            to_viewer=np.empty((count, 3), np.float32),
            base_colour=np.empty((count, 3), np.float32),
            alpha=np.empty(count, np.float32),
            metallic=np.empty(count, np.float32),
            roughness=np.empty(count, np.float32),
            dielectric_f0=np.empty(count, np.float32),
            transmission=np.empty(count, np.float32),
            emissive=np.empty((count, 3), np.float32),
            occlusion=np.empty(count, np.float32),
            unlit=np.empty(count, np.bool_),
            clearance=np.empty(count, np.float32),
            coat=Coat.empty(count if coated else 0),
            glass=Glass.empty(count if glassy else 0),
            brushed=Brushed.empty(count if brushed else 0),
        )

    @staticmethod
    def joined(parts: Sequence["Surface"]) -> "Surface":
        """Return the points of one or more parts of one scene, one after the other."""
        return records.joined(parts)

    def chosen(self, index: Longs | Bools) -> "Surface":
        """Return some points, as copies."""
        return records.chosen(self, index)

    def rows(self, begin: int, end: int) -> "Surface":
        """Return points begin..end as views, without a copy."""
        return records.rows(self, begin, end)
