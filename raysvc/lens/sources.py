"""What is spread together: the points of one slice at one resolution, row by row."""

from typing import Final, NamedTuple

from raysvc.types import Floats, Ints, Longs

CHANNELS: Final = 6
"""Red, green, blue and alpha, premultiplied; how much is covered; and how much of that is beside
what is in the next nearer slice, and not behind it."""
COVER: Final = 4
BESIDE: Final = 5


class Sources(NamedTuple):
    """N points that are spread, in a picture of H rows."""

    begin: Longs
    """(H,) number of the first point of each row."""
    end: Longs
    """(H,) number after that of its last."""
    column: Ints
    """(N,)."""
    size_px: Floats
    """(N,) diameter of the circle of confusion in pixels of this picture, negative before the
    focus."""
    values: Floats
    """(N, CHANNELS)."""
