"""All textures of a scene in one array that kernels can read, with their smaller sizes.

Williams 1983, "Pyramidal Parametrics": every level halves the last, each texel the mean of four,
taken in linear light where the texture holds colours.
"""

import numpy as np

from raysvc.scene import Scene, Texture
from raysvc.shading.mip_kernels import halve
from raysvc.shading.texel_kernels import CLAMP, MAX_LEVELS, MIRROR, REPEAT, TextureTable
from raysvc.types import Bytes, Floats

WRAPS = {"repeat": REPEAT, "clamp": CLAMP, "mirror": MIRROR}


def decodings() -> Floats:
    """(2, 256) float32: linear value of each 8-bit code as data, and as sRGB (IEC 61966-2-1)."""
    code = np.arange(256) / 255.0
    colour = np.where(code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4)
    return np.stack([code, colour]).astype(np.float32)


def texture_table(scene: Scene) -> TextureTable:
    """Pack a scene's textures; a texel array that several textures share is stored once."""
    colour = _colour_textures(scene)
    decoding = decodings()
    count = max(len(scene.textures), 1)
    start = np.zeros((count, MAX_LEVELS), np.int64)
    size = np.ones((count, MAX_LEVELS, 2), np.int32)
    levels = np.ones(count, np.int32)
    sampler = np.zeros((count, 3), np.int32)
    stored: dict[tuple[int, bool], int] = {}
    parts: list[Bytes] = []
    used = 0
    for number, texture in enumerate(scene.textures):
        sampler[number] = (
            WRAPS[texture.wrap_u],
            WRAPS[texture.wrap_v],
            int(texture.nearest),
        )
        same = stored.setdefault((id(texture.texels), number in colour), number)
        if same != number:
            start[number], size[number], levels[number] = start[same], size[same], levels[same]
            continue
        for level, texels in enumerate(_pyramid(texture, decoding[int(number in colour)])):
            start[number, level] = used
            size[number, level] = texels.shape[1], texels.shape[0]
            levels[number] = level + 1
            used += texels.shape[0] * texels.shape[1]
            parts.append(texels.reshape(-1, 4))
    texels = np.concatenate(parts) if parts else np.full((1, 4), 255, np.uint8)
    return TextureTable(texels, start, size, levels, sampler, decoding)


def _colour_textures(scene: Scene) -> set[int]:
    """Textures that hold sRGB colour: those that a base colour or emissive slot reads."""
    slots = [
        ref
        for material in scene.materials
        for ref in (material.base_colour_texture, material.emissive_texture)
    ]
    return {ref.texture for ref in slots if ref is not None}


def _pyramid(texture: Texture, decoding: Floats) -> list[Bytes]:
    thresholds = ((decoding[1:] + decoding[:-1]) / 2).astype(np.float32)
    pyramid = [np.ascontiguousarray(texture.texels)]
    while len(pyramid) < MAX_LEVELS and max(pyramid[-1].shape[:2]) > 1:
        last = pyramid[-1]
        height, width = max(last.shape[0] // 2, 1), max(last.shape[1] // 2, 1)
        smaller = np.empty((height, width, 4), np.uint8)
        halve(last, decoding, thresholds, smaller)
        pyramid.append(smaller)
    return pyramid
