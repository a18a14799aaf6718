"""Materials of OBJ files (.mtl) as metallic-roughness materials.

MTL describes Phong shading, so this is a translation: the diffuse colour becomes the base colour,
the exponent of the highlight a roughness of the same width, and a black diffuse colour with
a bright specular one a metal. Colours are taken as display values (sRGB), as the programs that
write these files show them. The keys Pr, Pm and norm of the common physically based extension win.

d and Tr are coverage. No illumination model makes glass: exporters set it out of habit, on meshes
that enclose nothing; those that ask for refraction are named.
"""

import math
import re
from collections.abc import Callable

from raysvc.errors import InvalidScene, LimitExceeded
from raysvc.limits import Limits
from raysvc.loading.files import Files, normalise
from raysvc.loading.images import decode_image
from raysvc.loading.obj_text import decode_text
from raysvc.scene import Material, Texture, TextureRef
from raysvc.types import Bytes

DEFAULT_COLOUR = (0.42, 0.42, 0.42, 1.0)
DEFAULT_ROUGHNESS = 0.5
PLAIN = Material("plain", DEFAULT_COLOUR, 0.0, DEFAULT_ROUGHNESS, double_sided=True)
"""What is made of no material that a file names."""

_MAPS = {"map_kd": "base", "map_ke": "emissive", "norm": "normal"}
_UNUSED_MAPS = (
    "map_ka", "map_ks", "map_ns", "map_d", "map_bump", "bump", "disp", "decal", "refl", "map_refl",
    "map_pr", "map_pm", "map_ps", "map_opacity",
)  # fmt: skip
_REFRACTING = (6, 7)
_DRIVE = re.compile(r"[A-Za-z]:[\\/]")
# Options of map statements by how many numbers may follow; -s and -o are scale and offset.
_OPTION = re.compile(
    r"\s*-(?P<key>s|o|t|mm|bm|boost|texres|blendu|blendv|cc|clamp|imfchan|type)"
    r"(?P<values>(?:\s+(?:[-+]?[\d.]+(?:[eE][-+]?\d+)?|on|off|[rgbmlz]|sphere|cube_\w+)(?=\s))+)"
)


class MaterialLibrary:
    """Materials and textures of all the .mtl files of a scene, and what was wrong with them."""

    def __init__(self, files: Files, limits: Limits) -> None:
        self.materials: dict[str, Material] = {}
        self.textures: list[Texture] = []
        self.warnings: list[str] = []
        self._files, self._limits = files, limits
        self._pictures: dict[str, Bytes | None] = {}
        self._pixels = 0

    def read(self, library: str) -> None:
        """Read one file; a missing one gives a warning. Raises InvalidScene, LimitExceeded."""
        found = self._found(library, "mtllib")
        if found is None:
            return
        text = decode_text(self._files.read(found, "mtllib"), library)
        statements: dict[str, str] = {}
        name: str | None = None
        for line in [*text.replace("\\\n", " ").splitlines(), "newmtl"]:
            key, _, rest = line.strip().partition(" ")
            if key.lower() == "newmtl":
                if name is not None and name not in self.materials:
                    self.materials[name] = self._material(name, statements)
                name, statements = rest.strip(), {}
                if len(self.materials) > self._limits.max_materials:
                    raise LimitExceeded(
                        f"more than {self._limits.max_materials} materials", library
                    )
            elif name is not None and key and not key.startswith("#"):
                statements[key.lower()] = rest.strip()

    def texture(self, name: str, clamp: bool = False) -> TextureRef | None:
        """Decode a picture, or warn that it is missing or damaged."""
        found = self._found(name, "texture")
        if found is None:
            return None
        if found not in self._pictures:
            self._pictures[found] = self._decoded(found)
        picture = self._pictures[found]
        if picture is None:
            return None
        wrap = "clamp" if clamp else "repeat"
        for number, texture in enumerate(self.textures):
            if texture.texels is picture and texture.wrap_u == wrap:
                return TextureRef(number)
        self.textures.append(Texture(picture, wrap, wrap, name=found))  # type: ignore[arg-type]
        return TextureRef(len(self.textures) - 1)

    def _material(self, name: str, statements: dict[str, str]) -> Material:
        numbers = _Numbers(statements, lambda what: self._warn(f"material {name}: {what}"))
        refs = {
            slot: self._map(statements[key]) for key, slot in _MAPS.items() if key in statements
        }
        for key in _UNUSED_MAPS:
            if key in statements:
                self._warn(f"material {name}: {key} is not used")
        model = int(numbers.number("illum", 2.0, 0.0, 10.0))
        if model in _REFRACTING:
            self._warn(f"material {name}: illum {model} refracts, which is not shown")
        diffuse = numbers.colour("kd") or DEFAULT_COLOUR[:3]
        specular = numbers.colour("ks") or (0.0, 0.0, 0.0)
        base = refs.get("base")
        if base is not None and max(diffuse) == 0.0:
            diffuse = (1.0, 1.0, 1.0)  # many exporters leave Kd black beside a map_Kd
        is_metal = base is None and max(diffuse) < 0.04 and max(specular) > 0.25
        alpha = numbers.number("d", 1.0 - numbers.number("tr", 0.0, 0.0, 1.0), 0.0, 1.0)
        cutout = base is not None and bool((self.textures[base.texture].texels[..., 3] < 255).any())
        return Material(
            name=name,
            base_colour=(*(specular if is_metal else diffuse), alpha),
            metallic=numbers.number("pm", float(is_metal), 0.0, 1.0),
            roughness=numbers.number("pr", _roughness(numbers), 0.0, 1.0),
            emissive=numbers.colour("ke") or ((1.0,) * 3 if "emissive" in refs else (0.0,) * 3),
            ior=_ior(numbers),
            alpha_mode="blend" if alpha < 1.0 else "mask" if cutout else "opaque",
            double_sided=True,
            base_colour_texture=base,
            normal_texture=refs.get("normal"),
            emissive_texture=refs.get("emissive"),
        )

    def _map(self, statement: str) -> TextureRef | None:
        """Texture of a map statement such as `-s 2 2 1 -clamp on wood.png`."""
        options: dict[str, list[str]] = {}
        while match := _OPTION.match(statement):
            options[match["key"]] = match["values"].split()
            statement = statement[match.end() :]
        ref = self.texture(statement.strip(), clamp=options.get("clamp") == ["on"])
        if ref is None or not {"s", "o"} & options.keys():
            return ref
        scale_u, scale_v = _pair(options.get("s", []), 1.0)
        offset_u, offset_v = _pair(options.get("o", []), 0.0)
        # MTL scales upwards from the bottom of the picture; our v is counted from the top.
        down = 1.0 - scale_v - offset_v
        return TextureRef(ref.texture, 0, (scale_u, 0.0, offset_u, 0.0, scale_v, down))

    def _found(self, name: str, field: str) -> str | None:
        """Name of a side file that is there; raises InvalidScene for URLs and escapes."""
        if _DRIVE.match(name):
            name = re.split(r"[\\/]", name)[-1]  # where it was on the machine that wrote the file
        normalise(name, field=field)
        if name in self._files:
            return name
        self._warn(f"{field} {name[:120]} is missing")
        return None

    def _decoded(self, name: str) -> Bytes | None:
        left = self._limits.max_scene_texture_pixels - self._pixels
        try:
            picture = decode_image(
                self._files.read(name, "texture"),
                min(self._limits.max_texture_pixels, left),
                name,
                ("PNG", "JPEG", "WEBP", "BMP", "TGA", "TIFF"),
            )
        except LimitExceeded:
            raise
        except InvalidScene as error:
            self._warn(str(error))
            return None
        self._pixels += picture.shape[0] * picture.shape[1]
        return picture

    def _warn(self, message: str) -> None:
        if message not in self.warnings:
            self.warnings.append(message)


class _Numbers:
    """Numbers of a material's statements; what cannot be read is said and left out."""

    def __init__(self, statements: dict[str, str], warn: Callable[[str], None]) -> None:
        self._statements, self._warn = statements, warn

    def colour(self, key: str) -> tuple[float, float, float] | None:
        """Linear colour of sRGB values; None where there is none."""
        values = self._values(key)
        if not values:
            return None
        red, green, blue = values[:3] if len(values) >= 3 else values[:1] * 3
        return (_linear(red), _linear(green), _linear(blue))

    def number(self, key: str, default: float, low: float, high: float) -> float:
        values = self._values(key)
        return min(max(values[-1], low), high) if values else default

    def _values(self, key: str) -> list[float]:
        words = self._statements.get(key, "").split()
        try:
            values = [float(word) for word in words if word != "-halo"]
        except ValueError:
            values = [math.nan]
        if not all(math.isfinite(value) for value in values):
            self._warn(f"{key} {' '.join(words)[:60]} is not understood")
            return []
        return values


def _linear(value: float) -> float:
    """From sRGB (IEC 61966-2-1) to linear; values above 1 stay as they are."""
    if value > 1.0:
        return min(value, 1e6)
    value = max(value, 0.0)
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4


def _roughness(numbers: _Numbers) -> float:
    """Roughness whose GGX lobe is as wide as a Blinn-Phong lobe of exponent Ns.

    alpha = sqrt(2 / (Ns + 2)) (Walter et al. 2007, "Microfacet Models for Refraction", section
    5.2), and roughness is the root of alpha. Illumination models 0 and 1 have no highlight at all.
    """
    if numbers.number("illum", 2.0, 0.0, 10.0) < 2.0:
        return 1.0
    exponent = numbers.number("ns", math.nan, 0.0, 1e6)
    return DEFAULT_ROUGHNESS if math.isnan(exponent) else (2.0 / (exponent + 2.0)) ** 0.25


def _ior(numbers: _Numbers) -> float:
    """Ni where it is an index of refraction at all; many files have 0 or 1 there."""
    ior = numbers.number("ni", 1.5, 0.0, 10.0)
    return ior if 1.05 <= ior <= 3.0 else 1.5


def _pair(values: list[str], default: float) -> tuple[float, float]:
    numbers = [float(value) for value in values[:2]]
    return (numbers + [default] * 2)[0], (numbers + [default] * 2)[1]
