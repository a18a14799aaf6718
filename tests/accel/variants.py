"""Our own structures, with the parameters that change how they work."""

VARIANTS = {
    "bvh": ("bvh", {}),
    "bvh of single triangles": ("bvh", {"max_leaf": 1}),
    "octant links": ("bvh_stackless", {"links": "octant"}),
    "skip pointers": ("bvh_stackless", {"links": "skip"}),
    "kd": ("kd", {}),
    "kd of bins": ("kd", {"exact_below": 1, "bins": 8, "traversal_cost": 0.5}),
    "bih": ("bih", {}),
    "bih of single triangles": ("bih", {"max_leaf": 1}),
    "bih of voxels": ("bih", {"split": "middle", "max_leaf": 2}),
}
