"""What materials share: factors within their range, and the slots that read textures."""

import math
from typing import Any

from raysvc.errors import InvalidScene
from raysvc.loading.gltf.extensions import TextureTransform, extension, note_unsupported
from raysvc.loading.gltf.journal import Journal
from raysvc.loading.gltf.textures import Textures
from raysvc.scene import TextureRef
from raysvc.scene.material import IDENTITY_UV, Affine

_STEEPEST = 1e3
"""Largest magnitude of a normal map's scale."""
_LARGEST_AFFINE = 1e6


class Slots:
    """Factors and texture slots of materials; what they cannot have is noted in the journal."""

    def __init__(self, textures: Textures, journal: Journal) -> None:
        self._textures, self.journal = textures, journal

    def within(self, value: float, largest: float, path: str) -> float:
        """Return a factor brought within 0..largest."""
        clamped = min(max(value, 0.0), largest)
        if clamped != value:
            self.journal.note(f"{value:g} is brought within 0..{largest:g}", path)
        return clamped

    def normal_scale(self, info: Any) -> float:
        """Return the scale of a normal map; 1 where there is none."""
        return 1.0 if info is None else min(max(info.scale, -_STEEPEST), _STEEPEST)

    def read(self, info: Any, path: str) -> TextureRef | None:
        """Return what a slot reads; `info` is any of pygltflib's three kinds, or None."""
        if info is None:
            return None
        if info.index is None:
            raise InvalidScene("is missing", f"{path}.index")
        note_unsupported(info, path, self.journal)
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
            self.journal.note(
                f"reads TEXCOORD_{uv_set}; only two sets are kept, so it is left out", path
            )
            return None
        return TextureRef(number, uv_set, affine)

    def check(self, info: Any, path: str) -> None:
        """Raise InvalidScene where a slot that nothing has to read refers to no texture."""
        if info is not None:
            if info.index is None:
                raise InvalidScene("is missing", f"{path}.index")
            self._textures.check(info.index, f"{path}.index")


def _affine(placed: TextureTransform) -> Affine:
    """Translation times rotation times scale, as KHR_texture_transform defines them."""
    cos, sin = math.cos(placed.rotation), math.sin(placed.rotation)
    (su, sv), (tu, tv) = placed.scale, placed.offset
    return (cos * su, sin * sv, tu, -sin * su, cos * sv, tv)
