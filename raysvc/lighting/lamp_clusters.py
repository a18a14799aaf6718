"""Glowing pieces put together to clusters.

Always the cluster is halved that matters most, by its power and its extent in place and direction
(compare Debevec 2005, "A Median Cut Algorithm for Light Probe Sampling", and Walter et al. 2005,
"Lightcuts").
"""

import numpy as np

from raysvc import records
from raysvc.lighting.lamp_kernels import Discs, Order, Pieces
from raysvc.lighting.sun import LUMINANCE
from raysvc.types import Doubles, Longs

CLUSTERS, MAX_CLUSTERS = 16, 64
SCATTERED = 8.0
"""Square of a cluster's extent over its area, above which it is halved even beyond CLUSTERS."""
TURN = 0.5
"""What a difference in direction counts for, against one of place as a part of all that glows."""


def clustered(pieces: Pieces) -> tuple[Pieces, Order, Discs]:
    """Put pieces (E,) together: those of one cluster next to each other, and clusters from afar."""
    clusters = _clusters(places(pieces), pieces.normal, areas(pieces), powers(pieces))
    pieces = records.chosen(pieces, np.concatenate(clusters))
    place, area, power = places(pieces), areas(pieces), powers(pieces)
    first = np.cumsum([0, *(len(cluster) for cluster in clusters)])

    def total(values: Doubles) -> Doubles:
        sums: Doubles = np.add.reduceat(values, first[:-1])
        return sums

    corners = pieces.corner[:, None] + np.pad(pieces.edges, ((0, 0), (1, 0), (0, 0)))
    low = np.minimum.reduceat(corners.min(axis=1), first[:-1])
    high = np.maximum.reduceat(corners.max(axis=1), first[:-1])
    all_power, all_area = total(power)[:, None], total(area)
    discs = Discs(
        total(place * power[:, None]) / all_power,
        total(pieces.normal * power[:, None]) / all_power,
        all_area,
        total(pieces.radiance * area[:, None]) / all_area[:, None],
        np.linalg.norm(high - low, axis=1),
    )
    return pieces, Order(np.cumsum(power), first), discs


def places(pieces: Pieces) -> Doubles:
    """(E, 3) middles of pieces."""
    middles: Doubles = pieces.corner + pieces.edges.sum(axis=1) / 3.0
    return middles


def areas(pieces: Pieces) -> Doubles:
    """(E,) square metres."""
    across = np.cross(pieces.edges[:, 0], pieces.edges[:, 1])
    metres2: Doubles = 0.5 * np.linalg.norm(across, axis=1)
    return metres2


def powers(pieces: Pieces) -> Doubles:
    """(E,) luminance times area."""
    power: Doubles = areas(pieces) * (pieces.radiance @ LUMINANCE)
    return power


def _clusters(place: Doubles, normal: Doubles, area: Doubles, power: Doubles) -> list[Longs]:
    """Put pieces together that are near each other: the numbers of those of each cluster."""
    whole = float(np.linalg.norm(np.ptp(place, axis=0)))
    at = np.concatenate([place, TURN * max(whole, 1e-30) * normal], axis=1)

    def weighed(cluster: Longs) -> tuple[float, bool, Longs]:
        """What halving a cluster is worth, whether it is scattered, and itself."""
        extent = np.ptp(at[cluster], axis=0)
        scattered = float(extent[:3] @ extent[:3]) > SCATTERED * float(area[cluster].sum())
        worth = float(power[cluster].sum()) * float(np.linalg.norm(extent))
        return (worth if len(cluster) > 1 else 0.0), scattered, cluster

    clusters = [weighed(np.arange(len(place)))]
    while len(clusters) < MAX_CLUSTERS:
        few = len(clusters) < CLUSTERS
        worth = [w if few or scattered else 0.0 for w, scattered, _ in clusters]
        most = int(np.argmax(worth))
        if worth[most] <= 0.0:
            break
        cluster = clusters[most][2]
        axis = int(np.ptp(at[cluster], axis=0).argmax())
        cluster = cluster[np.argsort(at[cluster, axis], kind="stable")]
        sums = np.cumsum(power[cluster])
        half = int(np.clip(np.searchsorted(sums, 0.5 * sums[-1]), 1, len(cluster) - 1))
        clusters[most : most + 1] = [weighed(cluster[:half]), weighed(cluster[half:])]
    return [cluster for _, _, cluster in clusters]
