"""Which samples of a pixel share one shading."""

from raysvc.jit import kernel
from raysvc.types import Ints, Longs


@kernel
def share_by_triangle(
    place: Longs, triangle: Ints, newest: Longs, older: Longs, shared: Longs
) -> int:
    """Number the different triangles of each pixel's hits; how many there are in all.

    Fill shared (N,): the number of hit n is that of all hits at place[n] on triangle[n]. Numbers
    are given in the order in which hits come. `newest` (P,), for P places, must hold -1; `older`
    (N,) is room to work in.
    """
    count = 0
    for n in range(len(place)):
        # The numbers of a place are a list, the newest first; the first hit of each is its link
        k = newest[place[n]]
        while k >= 0 and triangle[k] != triangle[n]:
            k = older[k]
        if k >= 0:
            shared[n] = shared[k]
        else:
            older[n] = newest[place[n]]
            newest[place[n]] = n
            shared[n] = count
            count += 1
    return count
