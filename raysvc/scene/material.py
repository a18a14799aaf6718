"""glTF 2.0 metallic-roughness materials (specification, section 3.9 and Appendix B), with what
KHR_materials_transmission, _volume, _ior, _clearcoat and _anisotropy add."""

from dataclasses import dataclass
from typing import Literal

AlphaMode = Literal["opaque", "mask", "blend"]
Affine = tuple[float, float, float, float, float, float]
IDENTITY_UV: Affine = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0)

TEXTURE_SLOTS = (
    "base_colour",
    "metallic_roughness",
    "normal",
    "occlusion",
    "emissive",
    "transmission",
    "clearcoat",
    "clearcoat_roughness",
    "clearcoat_normal",
    "anisotropy",
)
"""What a material may read from textures."""


@dataclass(frozen=True, slots=True)
class TextureRef:
    """Which texture a slot reads, and where."""

    texture: int
    """Index into `Scene.textures`."""
    uv_set: int = 0
    """0 or 1."""
    uv_transform: Affine = IDENTITY_UV
    """(a, b, c, d, e, f): u' = a u + b v + c, v' = d u + e v + f (KHR_texture_transform)."""


@dataclass(frozen=True, slots=True)
class Material:
    """What a triangle is made of; colours are linear Rec.709. The defaults are glTF's.

    Base colour and emissive textures are sRGB, the others linear. Roughness is the G and metalness
    the B channel of `metallic_roughness_texture`; occlusion, transmission and clearcoat are R,
    clearcoat roughness is G; anisotropy's direction is R and G, its strength B.
    """

    name: str = ""
    base_colour: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)
    """RGB and alpha."""
    metallic: float = 1.0
    roughness: float = 1.0
    """Perceptual: GGX alpha is its square."""
    emissive: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Radiance, KHR_materials_emissive_strength multiplied in."""
    ior: float = 1.5
    """Index of refraction: the dielectric's F0 is ((ior - 1) / (ior + 1))^2."""
    alpha_mode: AlphaMode = "opaque"
    alpha_cutoff: float = 0.5
    double_sided: bool = False
    unlit: bool = False
    """Show the base colour, unlit (KHR_materials_unlit)."""
    transmission: float = 0.0
    """Share of the light that enters which goes through, tinted by the base colour; the rest is
    diffused."""
    solid: bool = False
    """The triangles bound a volume of index `ior`, which refracts and absorbs; they are then seen
    from both sides. Else they are sheets without thickness. Only where something is transmitted."""
    absorption: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Of the volume, per metre: light falls as exp(-absorption x distance)."""
    clearcoat: float = 0.0
    """How much of the surface lies under a clear varnish of index 1.5."""
    clearcoat_roughness: float = 0.0
    clearcoat_normal_scale: float = 1.0
    anisotropy: float = 0.0
    """0..1: along the tangent GGX's alpha is mix(alpha, 1, anisotropy^2)."""
    anisotropy_rotation_rad: float = 0.0
    """Of that direction, counter-clockwise from the tangent."""
    normal_scale: float = 1.0
    occlusion_strength: float = 1.0
    base_colour_texture: TextureRef | None = None
    metallic_roughness_texture: TextureRef | None = None
    normal_texture: TextureRef | None = None
    occlusion_texture: TextureRef | None = None
    emissive_texture: TextureRef | None = None
    transmission_texture: TextureRef | None = None
    clearcoat_texture: TextureRef | None = None
    clearcoat_roughness_texture: TextureRef | None = None
    clearcoat_normal_texture: TextureRef | None = None
    anisotropy_texture: TextureRef | None = None

    def texture_refs(self) -> tuple[TextureRef | None, ...]:
        """What each of TEXTURE_SLOTS reads, in that order."""
        return tuple(getattr(self, f"{slot}_texture") for slot in TEXTURE_SLOTS)

    def numbers(self) -> tuple[float, ...]:
        """Every factor, and the texture transforms."""
        return (
            *self.base_colour,
            self.metallic,
            self.roughness,
            *self.emissive,
            self.ior,
            self.alpha_cutoff,
            self.normal_scale,
            self.occlusion_strength,
            self.transmission,
            *self.absorption,
            self.clearcoat,
            self.clearcoat_roughness,
            self.clearcoat_normal_scale,
            self.anisotropy,
            self.anisotropy_rotation_rad,
            *(x for ref in self.texture_refs() if ref is not None for x in ref.uv_transform),
        )
