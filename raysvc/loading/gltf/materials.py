"""Materials (specification, section 3.9, and the extensions that are understood)."""

import math
from typing import Any

import pygltflib

from raysvc.errors import InvalidScene, LimitExceeded
from raysvc.loading.gltf.document import Document
from raysvc.loading.gltf.extensions import (
    EmissiveStrength,
    Ior,
    TextureTransform,
    extension,
    note_unsupported,
)
from raysvc.loading.gltf.journal import Journal
from raysvc.loading.gltf.textures import Textures
from raysvc.scene import Material, TextureRef
from raysvc.scene.material import IDENTITY_UV, Affine, AlphaMode

_BRIGHTEST = 1e9
_STEEPEST = 1e3
"""Largest magnitude of a normal map's scale."""
_LARGEST_AFFINE = 1e6
_ALPHA_MODES: dict[str, AlphaMode] = {"OPAQUE": "opaque", "MASK": "mask", "BLEND": "blend"}


def read_materials(document: Document, textures: Textures) -> tuple[Material, ...]:
    """Return the document's materials in their order."""
    materials = document.gltf.materials
    limit = document.limits.max_materials
    if len(materials) > limit:
        raise LimitExceeded(f"{len(materials):,}; the limit is {limit:,}", "materials")
    return tuple(
        _read(material, f"materials[{number}]", textures, document.journal)
        for number, material in enumerate(materials)
    )


def _read(
    material: pygltflib.Material, path: str, textures: Textures, journal: Journal
) -> Material:
    note_unsupported(material, path, journal)
    surface = material.pbrMetallicRoughness or pygltflib.PbrMetallicRoughness()
    pbr = f"{path}.pbrMetallicRoughness"
    strength = extension(EmissiveStrength, "KHR_materials_emissive_strength", material, path)
    ior = extension(Ior, "KHR_materials_ior", material, path)
    if material.alphaMode not in _ALPHA_MODES:
        raise InvalidScene("is not OPAQUE, MASK or BLEND", f"{path}.alphaMode")
    slots = _Slots(textures, journal)
    glow = 1.0 if strength is None else strength.emissiveStrength
    base = [
        _within(factor, 1.0, f"{pbr}.baseColorFactor", journal)
        for factor in surface.baseColorFactor
    ]
    emissive = [
        _within(factor * glow, _BRIGHTEST, f"{path}.emissiveFactor", journal)
        for factor in material.emissiveFactor
    ]
    normal, occlusion = material.normalTexture, material.occlusionTexture
    return Material(
        name=material.name or "",
        base_colour=(base[0], base[1], base[2], base[3]),
        metallic=_within(surface.metallicFactor, 1.0, f"{pbr}.metallicFactor", journal),
        roughness=_within(surface.roughnessFactor, 1.0, f"{pbr}.roughnessFactor", journal),
        emissive=(emissive[0], emissive[1], emissive[2]),
        ior=1.5 if ior is None else _checked_ior(ior.ior, path),
        alpha_mode=_ALPHA_MODES[material.alphaMode],
        alpha_cutoff=0.5 if material.alphaCutoff is None else material.alphaCutoff,
        double_sided=material.doubleSided,
        unlit="KHR_materials_unlit" in (material.extensions or {}),
        normal_scale=1.0 if normal is None else min(max(normal.scale, -_STEEPEST), _STEEPEST),
        occlusion_strength=1.0
        if occlusion is None
        else _within(occlusion.strength, 1.0, f"{path}.occlusionTexture.strength", journal),
        base_colour_texture=slots.read(surface.baseColorTexture, f"{pbr}.baseColorTexture"),
        metallic_roughness_texture=slots.read(
            surface.metallicRoughnessTexture, f"{pbr}.metallicRoughnessTexture"
        ),
        normal_texture=slots.read(normal, f"{path}.normalTexture"),
        occlusion_texture=slots.read(occlusion, f"{path}.occlusionTexture"),
        emissive_texture=slots.read(material.emissiveTexture, f"{path}.emissiveTexture"),
    )


class _Slots:
    """Texture slots of a material."""

    def __init__(self, textures: Textures, journal: Journal) -> None:
        self._textures, self._journal = textures, journal

    def read(self, info: Any, path: str) -> TextureRef | None:
        """Return what a slot reads; `info` is any of pygltflib's three kinds, or None."""
        if info is None:
            return None
        if info.index is None:
            raise InvalidScene("is missing", f"{path}.index")
        note_unsupported(info, path, self._journal)
        uv_set = info.texCoord or 0
        placed = extension(TextureTransform, "KHR_texture_transform", info, path)
        affine = IDENTITY_UV if placed is None else _affine(placed)
        if max(map(abs, affine)) > _LARGEST_AFFINE:
            where = f"{path}.extensions.KHR_texture_transform"
            raise InvalidScene(f"moves or scales by more than {_LARGEST_AFFINE:g}", where)
        if placed is not None and placed.texCoord is not None:
            uv_set = placed.texCoord
        if uv_set < 0:
            raise InvalidScene("is negative", f"{path}.texCoord")
        number = self._textures.number(info.index, f"{path}.index")
        if number is None:
            return None
        if uv_set > 1:
            self._journal.note(
                f"reads TEXCOORD_{uv_set}; only two sets are kept, so it is left out", path
            )
            return None
        return TextureRef(number, uv_set, affine)


def _affine(placed: TextureTransform) -> Affine:
    """Translation times rotation times scale, as KHR_texture_transform defines them."""
    cos, sin = math.cos(placed.rotation), math.sin(placed.rotation)
    (su, sv), (tu, tv) = placed.scale, placed.offset
    return (cos * su, sin * sv, tu, -sin * su, cos * sv, tv)


def _checked_ior(ior: float, path: str) -> float:
    if ior != 0.0 and ior < 1.0:
        raise InvalidScene(
            "is neither 0 nor at least 1", f"{path}.extensions.KHR_materials_ior.ior"
        )
    return ior


def _within(value: float, largest: float, path: str, journal: Journal) -> float:
    clamped = min(max(value, 0.0), largest)
    if clamped != value:
        journal.note(f"{value:g} is brought within 0..{largest:g}", path)
    return clamped
