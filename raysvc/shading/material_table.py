"""Materials as arrays that kernels can read."""

from typing import NamedTuple

import numpy as np

from raysvc.scene import Material
from raysvc.scene.material import IDENTITY_UV
from raysvc.types import Floats, Ints

# Columns of MaterialTable.factors.
BASE, ALPHA, METALLIC, ROUGHNESS, EMISSIVE, F0, CUTOFF, NORMAL_SCALE, OCCLUSION_STRENGTH = (
    0,
    3,
    4,
    5,
    6,
    9,
    10,
    11,
    12,
)
FACTORS = 13

# Slots, in the order of Material.texture_refs().
BASE_SLOT, METALLIC_ROUGHNESS_SLOT, NORMAL_SLOT, OCCLUSION_SLOT, EMISSIVE_SLOT = range(5)
SLOTS = 5

OPAQUE, MASK, BLEND = range(3)


class MaterialTable(NamedTuple):
    """M materials; read-only."""

    factors: Floats
    """(M, FACTORS) float32, see the column numbers above."""
    texture: Ints
    """(M, SLOTS, 2) int32: texture (-1 none) and uv set of each slot."""
    uv_transform: Floats
    """(M, SLOTS, 6) float32, as in `TextureRef`."""
    flags: Ints
    """(M, 2) int32: alpha mode (OPAQUE, MASK, BLEND), unlit."""


def material_table(materials: tuple[Material, ...]) -> MaterialTable:
    """Lay materials out as arrays."""
    count = len(materials)
    factors = np.zeros((count, FACTORS), np.float32)
    texture = np.full((count, SLOTS, 2), -1, np.int32)
    uv_transform = np.tile(np.array(IDENTITY_UV, np.float32), (count, SLOTS, 1))
    flags = np.zeros((count, 2), np.int32)
    for row, material in enumerate(materials):
        f0 = ((material.ior - 1.0) / (material.ior + 1.0)) ** 2
        factors[row] = (
            *material.base_colour,
            material.metallic,
            material.roughness,
            *material.emissive,
            f0,
            material.alpha_cutoff,
            material.normal_scale,
            material.occlusion_strength,
        )
        flags[row] = (
            ("opaque", "mask", "blend").index(material.alpha_mode),
            int(material.unlit),
        )
        for slot, ref in enumerate(material.texture_refs()):
            if ref is not None:
                texture[row, slot] = ref.texture, ref.uv_set
                uv_transform[row, slot] = ref.uv_transform
    return MaterialTable(factors, texture, uv_transform, flags)
