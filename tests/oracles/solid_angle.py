"""What part of the directions a triangle covers."""

import numpy as np


def solid_angle(corners):
    """Steradians of a triangle (3, 3) seen from the origin.

    Van Oosterom and Strackee 1983, "The Solid Angle of a Plane Triangle".
    """
    a, b, c = corners
    la, lb, lc = np.linalg.norm(corners, axis=1)
    below = la * lb * lc + (a @ b) * lc + (a @ c) * lb + (b @ c) * la
    return 2 * abs(np.arctan2(np.linalg.det(corners), below))
