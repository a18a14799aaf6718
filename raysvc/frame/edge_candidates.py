"""Which pixels may hold an edge that can be seen, by the layers of the picture.

None of the tests looks at colours to find an edge: a texture has none. Colours only say whether
what was found can be seen.
"""

from typing import NamedTuple

import numpy as np

from raysvc.frame.draft import Draft
from raysvc.frame.reflections import Reflection, Transmission
from raysvc.frame.shared_rays import NARROW_PX
from raysvc.lighting.sun import LUMINANCE
from raysvc.raster.edge_kernels import UNKNOWN
from raysvc.raster.edges import shadow_edges, surface_edges, visible_contrast
from raysvc.types import Bools, Floats, Ints

LEAST_CONTRAST = 0.08
"""Between neighbours, of black to white: twenty steps of a screen's 255."""
CLEAR_CONTRAST = 0.1
"""The same for what is seen through glass, whose textures cannot be told from its edges."""
SHARP_PX = NARROW_PX[0]
"""Half width, where they end, of the cones of rays that show edges; those of rougher surfaces are
wide enough to blur them."""


class Candidates(NamedTuple):
    """Pixels that may hold a visible edge; all (H, W) bool."""

    shapes: Bools
    """Of what is seen."""
    shadows: Bools
    """Of a shadow on it."""
    beyond: Bools
    """Of what it mirrors or lets through, or grain of it."""


def edge_candidates(draft: Draft) -> Candidates:
    """Look for edges in what pixels show, in the light that falls on it, in mirrors and glass."""
    layers = draft.layers
    part = _part(draft, layers["id"])
    contrast = visible_contrast(draft.beauty)
    visible = contrast > LEAST_CONTRAST
    shapes = surface_edges(part, layers["depth"], layers["normal"])
    shadows = shadow_edges(part, _light(draft))
    beyond = _mirrored_edges(draft)
    if draft.frost is not None:
        beyond |= _is_sharp(draft, draft.transmission) & (contrast > CLEAR_CONTRAST)
    beyond |= draft.picture(draft.grainy, False)
    return Candidates(shapes & visible, shadows & visible, beyond & visible)


def _part(draft: Draft, triangle: Ints) -> Ints:
    """(H, W) int32 number of the object and material of triangles (H, W); -1 for none."""
    part: Ints = np.append(draft.part_of_triangle(), np.int32(-1))[triangle]
    return part


def _light(draft: Draft) -> Floats:
    """(H, W) light of the sun and of lamps that is returned, over the colour that returns it."""
    light = draft.direct @ LUMINANCE.astype(np.float32)
    colour = draft.points.surface.base_colour @ LUMINANCE.astype(np.float32)
    picture: Floats = draft.picture(light / np.maximum(colour, np.float32(0.01)), 0.0)
    return picture


def _mirrored_edges(draft: Draft) -> Bools:
    """(H, W) bool: edges of what sharp mirrors show."""
    reflection = draft.reflection
    if not (reflection.triangle >= 0).any():
        return np.zeros(draft.shape, np.bool_)
    part = _part(draft, draft.picture(reflection.triangle, -1))
    return surface_edges(
        np.where(_is_sharp(draft, reflection), part, np.int32(UNKNOWN)),
        draft.picture(reflection.distance, np.inf),
        draft.picture(reflection.normal, 0.0),
    )


def _is_sharp(draft: Draft, brought: Reflection | Transmission) -> Bools:
    """(H, W) bool: pixels whose rays show edges."""
    cone = draft.picture(np.maximum(brought.lobe_px, brought.spread_px), -1.0)
    sharp: Bools = (cone >= 0.0) & (cone < SHARP_PX)
    return sharp
