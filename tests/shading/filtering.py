"""One texture, read by kernels at a place over what a pixel covers of it."""

import numpy as np

from raysvc.scene import Material, Texture, TextureRef
from raysvc.shading.scene_tables import TEXTURE_FILTERS, SceneTables
from raysvc.shading.texel_kernels import COLOUR, DATA
from raysvc.shading.texture_kernels import filtered
from tests.scenes import quad

WRAPS = ("repeat", "clamp", "mirror")


class Reader:
    """Reads a texture; footprints are matrices J, columns the steps of a pixel, in texels."""

    def __init__(self, texels, wraps=("repeat", "repeat"), nearest=False, is_colour=False):
        ref = TextureRef(0)
        material = (
            Material(base_colour_texture=ref) if is_colour else Material(occlusion_texture=ref)
        )
        self.tables = SceneTables.of(
            quad(material, textures=(Texture(np.ascontiguousarray(texels), *wraps, nearest),))
        )
        self.size = np.array([texels.shape[1], texels.shape[0]], float)
        self.kind = COLOUR if is_colour else DATA

    def __call__(self, name, uv, steps):
        """Linear RGBA (4,) by a filter."""
        steps = np.asarray(steps, float) / self.size[:, None]
        m = steps @ steps.T
        textures = self.tables.textures
        at = (float(uv[0]), float(uv[1]))
        spread = (m[0, 0], m[0, 1], m[1, 1])
        sums = self.tables.sums.made()
        return np.array(filtered(textures, sums, 0, at, spread, TEXTURE_FILTERS[name], self.kind))

    def level(self, level):
        """Texels (h, w, 4) of a smaller size."""
        textures = self.tables.textures
        width, height = textures.size[0, level]
        begin = textures.start[0, level]
        return textures.texels[begin : begin + width * height].reshape(height, width, 4)


def random_texels(rng, height, width):
    return rng.integers(0, 256, (height, width, 4), np.uint8)


def steps_of(rng, longer, shorter):
    """A footprint (2, 2) with axes of these lengths, turned and sheared at random."""
    turn, mix = (
        np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])
        for a in rng.uniform(0, 2 * np.pi, 2)
    )
    return turn @ np.diag([longer, shorter]) @ mix
