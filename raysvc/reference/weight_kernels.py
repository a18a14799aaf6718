"""How much one way of finding light counts beside another: multiple importance sampling.

Veach and Guibas 1995, "Optimally Combining Sampling Techniques for Monte Carlo Rendering": the
power heuristic with exponent 2.
"""

from raysvc.jit import inlined, kernel
from raysvc.types import Doubles, Floats


@inlined
def mis_weight(own: float, other: float) -> float:
    """Weight of a sample drawn with density `own` that another way draws with density `other`.

    Both ways' weights of one direction sum to 1. A density that is inf is alone.
    """
    if other == 0.0:
        return 1.0
    ratio = other / own
    return 1.0 / (1.0 + ratio * ratio)


@kernel
def mis_weights(own: Doubles, other: Doubles, weight: Floats) -> None:
    """Fill weight (N,) for densities (N,), own ones positive; see `mis_weight`."""
    for n in range(len(own)):
        weight[n] = mis_weight(own[n], other[n])
