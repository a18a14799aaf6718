"""What a pixel covers of a texture, as a symmetric matrix: the sum of its steps' outer products.

With the steps of one pixel to the right and down as columns of J, the matrix is J J^T. It has the
variance of the parallelogram between them times twelve, it adds up over independent causes (the
pixel, and the blur of rough mirrors before it), and its eigenvalues are the squares of the axes of
the ellipse that Heckbert 1989 ("Fundamentals of Texture Mapping and Image Warping", section 3.5)
finds in J.
"""

import math

from raysvc.jit import inlined

Vec2 = tuple[float, float]
Spread = tuple[float, float, float]
"""(xx, xy, yy) of the matrix."""


@inlined
def turned_into(m: Spread, x_by: Vec2, y_by: Vec2) -> Spread:
    """The matrix of J' = [x_by; y_by] J, rows of a linear map: A M A^T."""
    along_x = (m[0] * x_by[0] + m[1] * x_by[1], m[1] * x_by[0] + m[2] * x_by[1])
    along_y = (m[0] * y_by[0] + m[1] * y_by[1], m[1] * y_by[0] + m[2] * y_by[1])
    return (
        x_by[0] * along_x[0] + x_by[1] * along_x[1],
        y_by[0] * along_x[0] + y_by[1] * along_x[1],
        y_by[0] * along_y[0] + y_by[1] * along_y[1],
    )


@inlined
def squared_axes(m: Spread) -> Vec2:
    """Squares of the longer and of the shorter axis: eigenvalues."""
    half_sum, half_difference = 0.5 * (m[0] + m[2]), 0.5 * (m[0] - m[2])
    longer = half_sum + math.sqrt(half_difference * half_difference + m[1] * m[1])
    if not longer > 0.0:
        return 0.0, 0.0
    # The product of both is the determinant: their difference would lose the shorter one.
    return longer, max((m[0] * m[2] - m[1] * m[1]) / longer, 0.0)


@inlined
def longer_direction(m: Spread, longer: float) -> Vec2:
    """Unit vector along the longer axis, whose square is given."""
    x, y = m[1], longer - m[0]
    if m[0] > m[2]:
        x, y = longer - m[2], m[1]
    length = math.sqrt(x * x + y * y)
    return (x / length, y / length) if length > 0.0 else (1.0, 0.0)


@inlined
def widened(m: Spread, longer: float, shorter: float, least: float) -> Spread:
    """The matrix with the square of its shorter axis lengthened to at least `least`."""
    if shorter >= least:
        return m
    # What is perpendicular to the longer axis is (longer I - M) / (longer - shorter).
    k = (least - shorter) / max(longer - shorter, 1e-300)
    return (m[0] + k * (longer - m[0]), m[1] - k * m[1], m[2] + k * (longer - m[2]))
