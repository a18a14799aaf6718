"""Materials (specification, section 3.9, and the extensions that are understood)."""

import pygltflib

from raysvc.errors import InvalidScene, LimitExceeded
from raysvc.loading.gltf.document import Document
from raysvc.loading.gltf.extensions import EmissiveStrength, Ior, extension, note_unsupported
from raysvc.loading.gltf.layers import with_layers
from raysvc.loading.gltf.slots import Slots
from raysvc.loading.gltf.textures import Textures
from raysvc.scene import Material
from raysvc.scene.material import AlphaMode

_BRIGHTEST = 1e9
_ALPHA_MODES: dict[str, AlphaMode] = {"OPAQUE": "opaque", "MASK": "mask", "BLEND": "blend"}


def read_materials(document: Document, textures: Textures) -> tuple[Material, ...]:
    """Return the document's materials in their order."""
    materials = document.gltf.materials
    limit = document.limits.max_materials
    if len(materials) > limit:
        raise LimitExceeded(f"{len(materials):,}; the limit is {limit:,}", "materials")
    slots = Slots(textures, document.journal)
    return tuple(
        _read(material, f"materials[{number}]", slots) for number, material in enumerate(materials)
    )


def _read(material: pygltflib.Material, path: str, slots: Slots) -> Material:
    note_unsupported(material, path, slots.journal)
    surface = material.pbrMetallicRoughness or pygltflib.PbrMetallicRoughness()
    pbr = f"{path}.pbrMetallicRoughness"
    strength = extension(EmissiveStrength, "KHR_materials_emissive_strength", material, path)
    ior = extension(Ior, "KHR_materials_ior", material, path)
    if material.alphaMode not in _ALPHA_MODES:
        raise InvalidScene("is not OPAQUE, MASK or BLEND", f"{path}.alphaMode")
    glow = 1.0 if strength is None else strength.emissiveStrength
    base = [
        slots.within(factor, 1.0, f"{pbr}.baseColorFactor") for factor in surface.baseColorFactor
    ]
    emissive = [
        slots.within(factor * glow, _BRIGHTEST, f"{path}.emissiveFactor")
        for factor in material.emissiveFactor
    ]
    normal, occlusion = material.normalTexture, material.occlusionTexture
    core = Material(
        name=material.name or "",
        base_colour=(base[0], base[1], base[2], base[3]),
        metallic=slots.within(surface.metallicFactor, 1.0, f"{pbr}.metallicFactor"),
        roughness=slots.within(surface.roughnessFactor, 1.0, f"{pbr}.roughnessFactor"),
        emissive=(emissive[0], emissive[1], emissive[2]),
        ior=1.5 if ior is None else _checked_ior(ior.ior, path),
        alpha_mode=_ALPHA_MODES[material.alphaMode],
        alpha_cutoff=0.5 if material.alphaCutoff is None else material.alphaCutoff,
        double_sided=material.doubleSided,
        unlit="KHR_materials_unlit" in (material.extensions or {}),
        normal_scale=slots.normal_scale(normal),
        occlusion_strength=1.0
        if occlusion is None
        else slots.within(occlusion.strength, 1.0, f"{path}.occlusionTexture.strength"),
        base_colour_texture=slots.read(surface.baseColorTexture, f"{pbr}.baseColorTexture"),
        metallic_roughness_texture=slots.read(
            surface.metallicRoughnessTexture, f"{pbr}.metallicRoughnessTexture"
        ),
        normal_texture=slots.read(normal, f"{path}.normalTexture"),
        occlusion_texture=slots.read(occlusion, f"{path}.occlusionTexture"),
        emissive_texture=slots.read(material.emissiveTexture, f"{path}.emissiveTexture"),
    )
    return with_layers(core, material, path, slots)


def _checked_ior(ior: float, path: str) -> float:
    if ior != 0.0 and ior < 1.0:
        raise InvalidScene(
            "is neither 0 nor at least 1", f"{path}.extensions.KHR_materials_ior.ior"
        )
    return ior
