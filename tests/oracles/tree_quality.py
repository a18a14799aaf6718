"""End-point overlap of a tree, by clipping every triangle to every box."""

import numpy as np


def area(polygon):
    """Area of a flat convex polygon (N, 3)."""
    if len(polygon) < 3:
        return 0.0
    edges = np.asarray(polygon[1:]) - polygon[0]
    return 0.5 * np.linalg.norm(np.cross(edges[:-1], edges[1:]).sum(axis=0))


def clipped(polygon, low, high):
    """The part of a convex polygon in a box."""
    for axis in range(3):
        for sign, plane in ((1.0, low[axis]), (-1.0, high[axis])):
            kept = []
            for here, there in zip(polygon, polygon[1:] + polygon[:1], strict=True):
                a, b = sign * (here[axis] - plane), sign * (there[axis] - plane)
                if a >= 0:
                    kept.append(here)
                if a * b < 0:
                    kept.append(here + (there - here) * (a / (a - b)))
            polygon = kept
    return polygon


def end_point_overlap(shape, positions, indices):
    """Sum over nodes of weight * foreign surface inside, by all surface; weights 1 or triangles."""
    corners = positions[indices].astype(float)
    boxes = shape.boxes.reshape(-1, 2, 3).astype(float)
    members = [set() for _ in boxes]
    for node in reversed(range(len(boxes))):
        if shape.left[node] < 0:
            begin = shape.first[node]
            members[node] = set(shape.order[begin : begin + shape.count[node]].tolist())
        else:
            members[node] = members[shape.left[node]] | members[shape.left[node] + 1]
    foreign = 0.0
    for node, (low, high) in enumerate(boxes):
        weight = 1 if shape.left[node] >= 0 else shape.count[node]
        for f in set(range(len(indices))) - members[node]:
            foreign += weight * area(clipped(list(corners[f]), low, high))
    return foreign / sum(area(list(triangle)) for triangle in corners)


def surface_area_cost(shape):
    """Expected steps and triangles of a ray that meets the root's box."""

    def size(box):
        x, y, z = box[1] - box[0]
        return x * y + y * z + z * x if min(x, y, z) >= 0 else 0.0

    boxes = shape.boxes.reshape(-1, 2, 3).astype(float)
    weights = np.where(shape.left >= 0, 1, shape.count)
    return sum(w * size(b) for w, b in zip(weights, boxes, strict=True)) / size(boxes[0])
