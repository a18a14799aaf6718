"""Extensions: which ones are understood, and what they hold."""

import math
from dataclasses import dataclass, field
from typing import Literal, TypeVar

import pygltflib

from raysvc.errors import Unsupported
from raysvc.loading.gltf.journal import Journal
from raysvc.loading.gltf.schema import decode

SUPPORTED = frozenset(
    {
        "EXT_mesh_gpu_instancing",
        "EXT_texture_webp",
        "KHR_lights_punctual",
        "KHR_materials_anisotropy",
        "KHR_materials_clearcoat",
        "KHR_materials_emissive_strength",
        "KHR_materials_ior",
        "KHR_materials_transmission",
        "KHR_materials_unlit",
        "KHR_materials_volume",
        "KHR_mesh_quantization",
        "KHR_texture_transform",
    }
)
# They add nothing that is seen, so ignoring them is right.
HARMLESS = frozenset({"KHR_xmp", "KHR_xmp_json_ld"})

Extension = TypeVar("Extension")


@dataclass
class TextureTransform:
    """KHR_texture_transform."""

    offset: list[float] = field(default_factory=lambda: [0.0, 0.0])
    rotation: float = 0.0
    scale: list[float] = field(default_factory=lambda: [1.0, 1.0])
    texCoord: int | None = None  # noqa: N815


@dataclass
class EmissiveStrength:
    """KHR_materials_emissive_strength."""

    emissiveStrength: float = 1.0  # noqa: N815


@dataclass
class Ior:
    """KHR_materials_ior."""

    ior: float = 1.5


@dataclass
class Transmission:
    """KHR_materials_transmission."""

    transmissionFactor: float = 0.0  # noqa: N815
    transmissionTexture: pygltflib.TextureInfo | None = None  # noqa: N815


@dataclass
class Volume:
    """KHR_materials_volume."""

    thicknessFactor: float = 0.0  # noqa: N815
    thicknessTexture: pygltflib.TextureInfo | None = None  # noqa: N815
    attenuationDistance: float = math.inf  # noqa: N815
    attenuationColor: list[float] = field(default_factory=lambda: [1.0, 1.0, 1.0])  # noqa: N815


@dataclass
class Clearcoat:
    """KHR_materials_clearcoat."""

    clearcoatFactor: float = 0.0  # noqa: N815
    clearcoatTexture: pygltflib.TextureInfo | None = None  # noqa: N815
    clearcoatRoughnessFactor: float = 0.0  # noqa: N815
    clearcoatRoughnessTexture: pygltflib.TextureInfo | None = None  # noqa: N815
    clearcoatNormalTexture: pygltflib.NormalMaterialTexture | None = None  # noqa: N815


@dataclass
class Anisotropy:
    """KHR_materials_anisotropy."""

    anisotropyStrength: float = 0.0  # noqa: N815
    anisotropyRotation: float = 0.0  # noqa: N815
    anisotropyTexture: pygltflib.TextureInfo | None = None  # noqa: N815


@dataclass
class TextureSource:
    """EXT_texture_webp."""

    source: int | None = None


@dataclass
class Instancing:
    """EXT_mesh_gpu_instancing."""

    attributes: pygltflib.Attributes


@dataclass
class Spot:
    """The cone of a spot light (KHR_lights_punctual)."""

    innerConeAngle: float = 0.0  # noqa: N815
    outerConeAngle: float = 0.7853981633974483  # noqa: N815


@dataclass
class Light:
    """One of KHR_lights_punctual's lights."""

    type: Literal["directional", "point", "spot"]
    name: str = ""
    color: list[float] = field(default_factory=lambda: [1.0, 1.0, 1.0])
    intensity: float = 1.0
    range: float | None = None
    spot: Spot | None = None


@dataclass
class Lights:
    """KHR_lights_punctual of the document."""

    lights: list[Light]


@dataclass
class LightOfNode:
    """KHR_lights_punctual of a node."""

    light: int


def extension(
    kind: type[Extension], name: str, owner: pygltflib.Property, path: str
) -> Extension | None:
    """Return extension `name` of `owner`, whose place is `path`, or None where it has none."""
    value = (owner.extensions or {}).get(name)
    if value is None:
        return None
    here = f"{path}." if path else ""
    return decode(kind, value, f"{here}extensions.{name}")


def note_unsupported(owner: pygltflib.Property, path: str, journal: Journal) -> None:
    """Warn of every extension of `owner` that is not understood."""
    for name in owner.extensions or {}:
        if name not in SUPPORTED and name not in HARMLESS:
            journal.note(f"{name[:80]} is not supported and ignored", path)


def check_required(document: pygltflib.GLTF2) -> None:
    """Raise Unsupported for an extension without which the file cannot be read."""
    for number, name in enumerate(document.extensionsRequired):
        if name not in SUPPORTED | HARMLESS:
            raise Unsupported(
                f"the file requires {name[:80]}, which is not supported",
                f"extensionsRequired[{number}]",
            )
