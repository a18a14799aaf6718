"""N points of surfaces with everything that light needs to know about them."""

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from raysvc.types import Bools, Floats, Longs


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """Points with materials evaluated; world space, linear Rec.709, float32 except `unlit`.

    Attributes
    ----------
    position
        (N, 3)
    geometric_normal
        (N, 3) unit normal of the triangle, on the viewer's side
    normal
        (N, 3) unit shading normal with the normal map applied, on the viewer's side
    view
        (N, 3) unit, from the point towards whoever looks (camera, or the origin of a reflected ray)
    base_colour, alpha
        (N, 3), (N,)
    metallic, roughness
        (N,), (N,) in 0..1; GGX alpha is roughness squared
    dielectric_f0
        (N,) reflectance at normal incidence where it is not metal
    emissive
        (N, 3) radiance
    occlusion
        (N,) 0..1 from the material's occlusion texture, strength applied; for light from the
        environment only
    unlit
        (N,) bool: shows `base_colour` and nothing else
    clearance
        (N,) metres off the triangle at which a ray surely does not meet it
    """

    position: Floats
    geometric_normal: Floats
    normal: Floats
    view: Floats
    base_colour: Floats
    alpha: Floats
    metallic: Floats
    roughness: Floats
    dielectric_f0: Floats
    emissive: Floats
    occlusion: Floats
    unlit: Bools
    clearance: Floats

    def __len__(self) -> int:
        return len(self.position)

    @staticmethod
    def joined(parts: Sequence["Surface"]) -> "Surface":
        """Return the points of one or more parts, one after the other."""
        return Surface(
            **{f.name: np.concatenate([getattr(p, f.name) for p in parts]) for f in fields(Surface)}
        )

    def chosen(self, index: Longs | Bools) -> "Surface":
        """Return some points, as copies."""
        return Surface(**{f.name: getattr(self, f.name)[index] for f in fields(self)})

    def rows(self, begin: int, end: int) -> "Surface":
        """Return points begin..end as views, without a copy."""
        return Surface(**{f.name: getattr(self, f.name)[begin:end] for f in fields(self)})
