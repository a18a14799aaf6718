"""Textures made in code. All of them tile."""

import numpy as np

from raysvc.scene import Texture
from raysvc.types import Bytes, Doubles

Colour = tuple[int, int, int]


def chequer(light: Colour, dark: Colour) -> Texture:
    """Two by two fields of sRGB colours with sharp edges."""
    fields = np.array([[light, dark], [dark, light]], np.uint8)
    return Texture(_opaque(fields), nearest=True, name="chequer")


def mottled(size: int, contrast: float, seed: int) -> Texture:
    """Soft grey spots of all sizes, about as bright as sRGB 225."""
    return Texture(_grey(225.0 + contrast * cloud(size, 1.1, seed)), name="mottled")


def paving(size: int, rows: int, seed: int) -> Texture:
    """Stone slabs in running bond, twice as long as wide, no two alike, with dark joints."""
    rng = np.random.default_rng(seed)
    v, u = (np.indices((size, size)) + 0.5) / size
    row = np.floor(v * rows).astype(np.int64)
    across = u * rows / 2 + 0.5 * (row % 2)
    column = np.floor(across).astype(np.int64) % (rows // 2)
    tone = 205.0 + 34.0 * (rng.random((rows, rows // 2)) - 0.5)[row, column]
    # Distance to the nearest joint, in heights of a slab.
    to_side = np.minimum(across % 1.0, 1.0 - across % 1.0) * 2.0
    to_end = np.minimum(v * rows % 1.0, 1.0 - v * rows % 1.0)
    joint = np.clip((np.minimum(to_side, to_end) - 0.03) / 0.05, 0.0, 1.0)
    return Texture(
        _grey((tone + 9.0 * cloud(size, 0.8, seed)) * (0.5 + 0.5 * joint)), name="paving"
    )


def cloud(size: int, falloff: float, seed: int) -> Doubles:
    """(size, size) tiling noise, mean 0, deviation 1: amplitudes fall as frequency^-falloff."""
    frequency = np.hypot(*np.meshgrid(np.fft.rfftfreq(size), np.fft.fftfreq(size)))
    frequency[0, 0] = np.inf
    phase = 2.0 * np.pi * np.random.default_rng(seed).random(frequency.shape)
    noise = np.fft.irfft2(frequency**-falloff * np.exp(1j * phase), (size, size))
    return np.asarray(noise / noise.std())


def _grey(tone: Doubles) -> Bytes:
    values = np.clip(np.round(tone), 0, 255).astype(np.uint8)
    return _opaque(np.repeat(values[..., None], 3, axis=2))


def _opaque(rgb: Bytes) -> Bytes:
    return np.concatenate([rgb, np.full((*rgb.shape[:2], 1), 255, np.uint8)], axis=2)
