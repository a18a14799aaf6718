"""glTF 2.0 metallic-roughness materials (specification, section 3.9 and Appendix B)."""

from dataclasses import dataclass
from typing import Literal

AlphaMode = Literal["opaque", "mask", "blend"]
Affine = tuple[float, float, float, float, float, float]
IDENTITY_UV: Affine = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0)


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
    the B channel of `metallic_roughness_texture`; occlusion is R.
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
    normal_scale: float = 1.0
    occlusion_strength: float = 1.0
    base_colour_texture: TextureRef | None = None
    metallic_roughness_texture: TextureRef | None = None
    normal_texture: TextureRef | None = None
    occlusion_texture: TextureRef | None = None
    emissive_texture: TextureRef | None = None

    def texture_refs(self) -> tuple[TextureRef | None, ...]:
        """The five slots, in the order base, metallic-roughness, normal, occlusion, emissive."""
        return (
            self.base_colour_texture,
            self.metallic_roughness_texture,
            self.normal_texture,
            self.occlusion_texture,
            self.emissive_texture,
        )

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
            *(x for ref in self.texture_refs() if ref is not None for x in ref.uv_transform),
        )
