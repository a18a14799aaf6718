"""Reflections of rough surfaces, without noise, from one ray a pixel.

Each pixel's ray goes to another place of its lobe than its neighbours' (`tile_pattern`), and every
pixel takes a mean of the rays about it. The question is how wide: a neighbour's mirror image is
shifted, and what is near must stay sharp. A ray's light therefore spreads over as many pixels as
the lobe covers where the ray ends: many for what is far, none for what the mirror touches. A lobe
narrower than a pixel needs no other rays, and one that covers many pixels has many to share.
"""

import math
from dataclasses import dataclass

import numpy as np

from raysvc.tracing.gloss_kernels import gather_gloss
from raysvc.types import Floats, Longs

GATHER = 0.2
"""Standard deviation of the mean over neighbours, as a part of the lobe's half width: it widens the
lobe by an eighth."""


def weight_of_rays(weight: Floats, spread_px: Floats, lobe_px: Floats) -> Floats:
    """(N,) how much rays count in means over neighbours.

    A ray in the tail of a lobe spreads its light over more pixels than one in the middle, and
    counts the less in each of them; while it reaches no other pixel it counts as much.

    Parameters
    ----------
    weight
        (N,) of the rays among those of their own pixel
    spread_px, lobe_px
        (N,) half widths where the rays end, of their own cones and of those in the middle
    """
    area = 2.0 * math.pi * GATHER * GATHER
    spread = np.square(np.maximum(spread_px, 0.0))
    part = (1.0 + area * np.square(np.maximum(lobe_px, 0.0))) / (1.0 + area * spread)
    return (weight * part).astype(np.float32)


@dataclass(frozen=True, slots=True, eq=False)
class GlossPicture:
    """What the rays of pixels brought, and what tells one surface from another; H x W, float32.

    Attributes
    ----------
    radiance
        (H, W, 3) of what the pixel's ray met
    share
        (H, W) part of the lobe that it stands for; 0 where it met nothing, -1 where there was none
    weight
        (H, W) how much the ray counts
    spread_px
        (H, W) half width of the lobe where the ray ends, in pixels
    roughness, depth, depth_step
        (H, W) of the surface; metres along the view axis; how much depth may differ per pixel
    normal
        (H, W, 3) unit
    """

    radiance: Floats
    share: Floats
    weight: Floats
    spread_px: Floats
    roughness: Floats
    depth: Floats
    depth_step: Floats
    normal: Floats

    def gathered(
        self, pixel: Longs, depth: Floats, normal: Floats, roughness: Floats
    ) -> tuple[Floats, Floats]:
        """Radiance (N, 3) and share (N,) of points in pixels (N,); share is -1 if nothing is known.

        depth (N,), normal (N, 3) and roughness (N,) say which of the pixels show their surface.
        """
        gathered = np.empty((len(pixel), 4), np.float32)
        gather_gloss(
            self.radiance,
            self.share,
            self.weight,
            GATHER * self.spread_px,
            self.roughness,
            self.depth,
            self.normal,
            self.depth_step,
            pixel,
            depth,
            normal,
            roughness,
            gathered,
        )
        return np.ascontiguousarray(gathered[:, :3]), gathered[:, 3].copy()
