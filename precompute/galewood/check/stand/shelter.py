"""Shelter in a stand: how the largest bending moment falls from the windward edge inwards.

By wind-tunnel measurements of model forests as ForestGALES uses them (Gardiner, Peltola, Kellomäki,
Ecological Modelling 129, 2000; coefficients as in the R package fgr): the largest moment in gusts at the
distance x from the edge, of trees of the height h at the mean spacing s, is in proportion to

    (2.7193 s/h − 0.061) + (0.9701 − 1.273 s/h) (1.1127 s/h + 0.0311)^(x/h)

It is taken relative to that at the edge, where a tree is assumed to bear the wind of the open.
"""

from __future__ import annotations

import numpy as np

from galewood.util import Floats

SPACING_PER_HEIGHT_LIMITS = (0.075, 0.45)
"""Range of s/h of the measurements."""
FARTHEST_HEIGHTS = 9.0
"""Distance from the edge, in heights, beyond which nothing changes."""
CORRIDOR_SPACINGS = 1.0
"""Half the width of the strip to windward in which stems shelter, in mean spacings."""
GAP_HEIGHTS = 1.0
GAP_SPACINGS = 3.0
"""A strip without stems as long as the larger of these is an edge: in mean heights, in mean spacings."""


def shelter_factor(distance_m: Floats, height_m: float, spacing_m: float) -> Floats:
    """(n,) largest bending moment over that at the edge, at distances (n,) from it."""
    ratio = float(np.clip(spacing_m / height_m, *SPACING_PER_HEIGHT_LIMITS))
    inwards = np.clip(distance_m / height_m, 0.0, FARTHEST_HEIGHTS)
    return _largest_moment(inwards, ratio) / _largest_moment(np.zeros(1), ratio)


def _largest_moment(inwards: Floats, ratio: float) -> Floats:
    deep = 2.7193 * ratio - 0.061
    return deep + (0.9701 - 1.273 * ratio) * (1.1127 * ratio + 0.0311) ** inwards


def edge_distances_m(place_m: Floats, direction_deg: float, height_m: float, spacing_m: float) -> Floats:
    """(n,) distance of stems (n, 2) at (x, z) from the edge that a wind towards a direction meets first.

    The edge is the first gap to windward in a strip about each stem.
    """
    angle = np.radians(direction_deg)
    along = place_m @ np.array([np.cos(angle), np.sin(angle)])
    across = place_m @ np.array([-np.sin(angle), np.cos(angle)])
    order = np.argsort(across)
    sorted_across, sorted_along = across[order], along[order]
    half = CORRIDOR_SPACINGS * spacing_m
    gap = max(GAP_HEIGHTS * height_m, GAP_SPACINGS * spacing_m)
    low = np.searchsorted(sorted_across, across - half)
    high = np.searchsorted(sorted_across, across + half, side="right")
    found = np.zeros(len(place_m))
    for k, (first, last) in enumerate(zip(low, high, strict=True)):
        ahead = along[k] - sorted_along[first:last]
        ahead = np.sort(ahead[ahead >= 0])
        steps = np.flatnonzero(np.diff(ahead) > gap)
        found[k] = ahead[steps[0]] if len(steps) else ahead[-1]
    return found
