"""Materials as arrays that kernels can read."""

import math
from typing import NamedTuple

import numpy as np

from raysvc.scene import Material
from raysvc.scene.material import IDENTITY_UV
from raysvc.types import Floats, Ints

# Columns of MaterialTable.factors.
BASE, ALPHA, METALLIC, ROUGHNESS, EMISSIVE, F0, CUTOFF = 0, 3, 4, 5, 6, 9, 10
NORMAL_SCALE, OCCLUSION_STRENGTH, TRANSMISSION, IOR, ABSORPTION = 11, 12, 13, 14, 15
COAT, COAT_ROUGHNESS, COAT_NORMAL_SCALE = 18, 19, 20
BRUSHING, BRUSHING_TURN = 21, 22  # cosine and sine
FACTORS = 24

# Slots, in the order of raysvc.scene.material.TEXTURE_SLOTS.
(
    BASE_SLOT,
    METALLIC_ROUGHNESS_SLOT,
    NORMAL_SLOT,
    OCCLUSION_SLOT,
    EMISSIVE_SLOT,
    TRANSMISSION_SLOT,
    COAT_SLOT,
    COAT_ROUGHNESS_SLOT,
    COAT_NORMAL_SLOT,
    BRUSHING_SLOT,
) = range(10)
SLOTS = 10

OPAQUE, MASK, BLEND = range(3)

LEAST_IOR = 1.0001
"""Of a solid: at 1 nothing is bent, and a rough boundary's lobe would have no width."""


class MaterialTable(NamedTuple):
    """M materials; read-only."""

    factors: Floats
    """(M, FACTORS) float32, see the column numbers above."""
    texture: Ints
    """(M, SLOTS, 2) int32: texture (-1 none) and uv set (0 if there is none) of each slot."""
    uv_transform: Floats
    """(M, SLOTS, 6) float32, as in `TextureRef`."""
    flags: Ints
    """(M, 3) int32: alpha mode (OPAQUE, MASK, BLEND), unlit, solid."""


def material_table(materials: tuple[Material, ...]) -> MaterialTable:
    """Lay materials out as arrays."""
    count = len(materials)
    factors = np.zeros((count, FACTORS), np.float32)
    texture = np.full((count, SLOTS, 2), -1, np.int32)
    texture[:, :, 1] = 0
    uv_transform = np.tile(np.array(IDENTITY_UV, np.float32), (count, SLOTS, 1))
    flags = np.zeros((count, 3), np.int32)
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
            material.transmission,
            max(material.ior, LEAST_IOR),
            *material.absorption,
            material.clearcoat,
            material.clearcoat_roughness,
            material.clearcoat_normal_scale,
            material.anisotropy,
            math.cos(material.anisotropy_rotation_rad),
            math.sin(material.anisotropy_rotation_rad),
        )
        flags[row] = (
            ("opaque", "mask", "blend").index(material.alpha_mode),
            int(material.unlit),
            int(material.solid),
        )
        for slot, ref in enumerate(material.texture_refs()):
            if ref is not None:
                texture[row, slot] = ref.texture, ref.uv_set
                uv_transform[row, slot] = ref.uv_transform
    return MaterialTable(factors, texture, uv_transform, flags)
