"""In which order rays are traced and what they meet is shaded. The picture is always the same.

    passes   trees
    single   either         trace everything, then shade what is nearest, in one go
    multi    one            trace everything, then shade what is nearest, material by material
    multi    per_material   for each material's tree: trace up to the nearest hit so far, and shade
                            what is nearer at once; later passes write over it

The last is how the talk of 2009 used its four trees on a GPU, with a distance buffer; a hit that a
later pass writes over was shaded in vain.
"""

import time
from collections.abc import Callable
from typing import Final

import numpy as np

from raysvc import records
from raysvc.accel.base import Hits, Rays
from raysvc.frame.radiance import Lit
from raysvc.frame.statistics import Ledger
from raysvc.tracing.world import World
from raysvc.types import Ints, Longs

Shade = Callable[[Longs, Hits], Lit]
"""Light N hits of the rays with these numbers (N,)."""


def single(
    world: World, rays: Rays, material_of_triangle: Ints, shade: Shade, ledger: Ledger
) -> tuple[Hits, Longs, Lit]:
    """Trace everything, then shade.

    Parameters
    ----------
    world
        what rays meet
    rays
        R rays
    material_of_triangle
        (F,) int32
    shade
        must give each hit the same light in whatever company it comes
    ledger
        hears of traces, shaded hits and seconds

    Returns
    -------
    the nearest hits of all R rays, the numbers (M,) of those rays that met something, in order,
    and the light of these M hits
    """
    start = time.perf_counter()
    hits = world.nearest(rays)
    met = np.flatnonzero(hits.triangle >= 0)
    traced = time.perf_counter()
    lit = shade(met, records.chosen(hits, met))
    ledger.shading(
        traces=len(rays) * world.trees,
        shaded=len(met),
        trace_seconds=traced - start,
        shade_seconds=time.perf_counter() - traced,
    )
    return hits, met, lit


def by_material(
    world: World, rays: Rays, material_of_triangle: Ints, shade: Shade, ledger: Ledger
) -> tuple[Hits, Longs, Lit]:
    """Trace everything, then shade in batches of one material each; see `single`."""
    start = time.perf_counter()
    hits = world.nearest(rays)
    met = np.flatnonzero(hits.triangle >= 0)
    traced = time.perf_counter()
    material = material_of_triangle[hits.triangle[met]]
    order = np.argsort(material, kind="stable")
    ends = np.flatnonzero(np.diff(material[order])) + 1
    parts = [shade(met[batch], records.chosen(hits, met[batch])) for batch in np.split(order, ends)]
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    lit = records.chosen(records.joined(parts), place)
    ledger.shading(
        traces=len(rays) * world.trees,
        shaded=len(met),
        trace_seconds=traced - start,
        shade_seconds=time.perf_counter() - traced,
    )
    return hits, met, lit


def tree_by_tree(
    world: World, rays: Rays, material_of_triangle: Ints, shade: Shade, ledger: Ledger
) -> tuple[Hits, Longs, Lit]:
    """Trace and shade tree by tree, against the distances known so far; see `single`."""
    so_far = world.unasked(rays)
    owner = np.full(len(rays), -1)
    parts = [shade(np.zeros(0, np.int64), records.chosen(so_far.hits(), np.zeros(0, np.int64)))]
    shaded = 0
    for number in range(world.trees):
        start = time.perf_counter()
        before = so_far.triangle.copy()
        world.narrow(number, so_far)
        nearer = np.flatnonzero(so_far.triangle != before)
        hits = so_far.hits()
        traced = time.perf_counter()
        parts.append(shade(nearer, records.chosen(hits, nearer)))
        owner[nearer] = shaded + np.arange(len(nearer))
        shaded += len(nearer)
        ledger.shading(
            traces=len(rays),
            shaded=len(nearer),
            trace_seconds=traced - start,
            shade_seconds=time.perf_counter() - traced,
        )
    met = np.flatnonzero(owner >= 0)
    ledger.shading(wasted=shaded - len(met))
    return so_far.hits(), met, records.chosen(records.joined(parts), owner[met])


ORGANISATIONS: Final = {
    ("single", "one"): single,
    ("single", "per_material"): single,
    ("multi", "one"): by_material,
    ("multi", "per_material"): tree_by_tree,
}
"""By the settings `passes` and `trees`."""
