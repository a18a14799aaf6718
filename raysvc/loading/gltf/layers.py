"""What light passes on a material: glass (KHR_materials_transmission, KHR_materials_volume),
varnish (KHR_materials_clearcoat), and scratches (KHR_materials_anisotropy).
"""

import math
from dataclasses import replace

import pygltflib

from raysvc.errors import InvalidScene
from raysvc.loading.gltf.extensions import Anisotropy, Clearcoat, Transmission, Volume, extension
from raysvc.loading.gltf.slots import Slots
from raysvc.scene import Material

_TRANSMISSION = "KHR_materials_transmission"
_VOLUME = "KHR_materials_volume"
_CLEARCOAT = "KHR_materials_clearcoat"
_ANISOTROPY = "KHR_materials_anisotropy"
_DENSEST = 1e6
"""Largest absorption per metre: a micrometre of it is black enough."""


def with_layers(material: Material, given: pygltflib.Material, path: str, slots: Slots) -> Material:
    """Return a material with the layers that the document gives it at `path`.

    The extensions exclude KHR_materials_unlit: an unlit material has none, which is noted.
    """
    if material.unlit:
        for name in (_TRANSMISSION, _VOLUME, _CLEARCOAT, _ANISOTROPY):
            if name in (given.extensions or {}):
                slots.journal.note(f"{name} is left out, for the material is unlit", path)
        return material
    material = _with_transmission(material, given, path, slots)
    material = _with_clearcoat(material, given, path, slots)
    return _with_anisotropy(material, given, path, slots)


def _with_transmission(
    material: Material, given: pygltflib.Material, path: str, slots: Slots
) -> Material:
    transmission = extension(Transmission, _TRANSMISSION, given, path) or Transmission()
    volume = extension(Volume, _VOLUME, given, path) or Volume()
    here, within = f"{path}.extensions.{_TRANSMISSION}", f"{path}.extensions.{_VOLUME}"
    share = slots.within(transmission.transmissionFactor, 1.0, f"{here}.transmissionFactor")
    thickness = slots.within(volume.thicknessFactor, math.inf, f"{within}.thicknessFactor")
    # How thick it is underneath is for those who cannot trace rays; a ray finds out.
    slots.check(volume.thicknessTexture, f"{within}.thicknessTexture")
    solid = share > 0.0 and thickness > 0.0
    absorption = _absorption(volume, within, slots)
    return replace(
        material,
        transmission=share,
        transmission_texture=slots.read(
            transmission.transmissionTexture, f"{here}.transmissionTexture"
        ),
        solid=solid,
        absorption=absorption if solid else (0.0, 0.0, 0.0),
    )


def _absorption(volume: Volume, path: str, slots: Slots) -> tuple[float, float, float]:
    """-ln(colour) / distance, per metre (KHR_materials_volume, "Attenuation")."""
    if volume.attenuationDistance <= 0.0:
        raise InvalidScene("is not greater than 0", f"{path}.attenuationDistance")
    red, green, blue = (
        min(-math.log(max(left, 1e-300)) / volume.attenuationDistance, _DENSEST)
        for left in (
            slots.within(each, 1.0, f"{path}.attenuationColor") for each in volume.attenuationColor
        )
    )
    return (red, green, blue)


def _with_clearcoat(
    material: Material, given: pygltflib.Material, path: str, slots: Slots
) -> Material:
    coat = extension(Clearcoat, _CLEARCOAT, given, path)
    if coat is None:
        return material
    here = f"{path}.extensions.{_CLEARCOAT}"
    return replace(
        material,
        clearcoat=slots.within(coat.clearcoatFactor, 1.0, f"{here}.clearcoatFactor"),
        clearcoat_roughness=slots.within(
            coat.clearcoatRoughnessFactor, 1.0, f"{here}.clearcoatRoughnessFactor"
        ),
        clearcoat_normal_scale=slots.normal_scale(coat.clearcoatNormalTexture),
        clearcoat_texture=slots.read(coat.clearcoatTexture, f"{here}.clearcoatTexture"),
        clearcoat_roughness_texture=slots.read(
            coat.clearcoatRoughnessTexture, f"{here}.clearcoatRoughnessTexture"
        ),
        clearcoat_normal_texture=slots.read(
            coat.clearcoatNormalTexture, f"{here}.clearcoatNormalTexture"
        ),
    )


def _with_anisotropy(
    material: Material, given: pygltflib.Material, path: str, slots: Slots
) -> Material:
    brushing = extension(Anisotropy, _ANISOTROPY, given, path)
    if brushing is None:
        return material
    here = f"{path}.extensions.{_ANISOTROPY}"
    return replace(
        material,
        anisotropy=slots.within(brushing.anisotropyStrength, 1.0, f"{here}.anisotropyStrength"),
        anisotropy_rotation_rad=math.remainder(brushing.anisotropyRotation, math.tau),
        anisotropy_texture=slots.read(brushing.anisotropyTexture, f"{here}.anisotropyTexture"),
    )
