"""The mean over neighbours, one pixel and one neighbour at a time."""

import math


def gathered(picture, gather, row, col, depth, normal, roughness, reach=4):
    """(radiance, share) of a point in a pixel; share is -1 where no neighbour knows anything."""
    height, width = picture.share.shape
    rays = []
    for y in range(height):
        for x in range(width):
            if max(abs(y - row), abs(x - col)) > reach or picture.share[y, x] < 0:
                continue
            if picture.spread_px[y, x] == 0 and (y, x) != (row, col):
                continue
            sigma = max(gather * float(picture.spread_px[y, x]), 0.45)
            near = math.exp(-((y - row) ** 2 + (x - col) ** 2) / (2 * sigma**2))
            alike = (
                near >= 0.01
                and float(picture.normal[y, x] @ normal) > 0.9
                and abs(float(picture.roughness[y, x]) - roughness) < 0.1
                and abs(float(picture.depth[y, x]) - depth)
                <= picture.depth_step[y, x] * (abs(y - row) + abs(x - col) + 1)
            )
            if alike:
                rays.append((near * float(picture.weight[y, x]), y, x))
    total = sum(w for w, _, _ in rays)
    if total <= 0:
        return (0.0, 0.0, 0.0), -1.0
    met = sum(w * float(picture.share[y, x]) for w, y, x in rays)
    radiance = tuple(
        sum(w * float(picture.share[y, x] * picture.radiance[y, x, k]) for w, y, x in rays)
        / (met or 1.0)
        for k in range(3)
    )
    return radiance, met / total
