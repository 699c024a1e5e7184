"""Places of a crown: where the modal model takes the gusts, and the gust at every node estimated from theirs.

The gust at a node is estimated from those at the places by kriging: the linear estimate with the smallest
mean square error, for the crown field of `motion.wind.crown` in any wind direction. The estimate for a node
between the places is weaker than the gust there, as it should be: what the places do not know averages out.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from galewood.motion.wind import crown_field, write_gusts
from galewood.pipeline.reduction.clusters import clusters
from galewood.util import Floats, Singles

if TYPE_CHECKING:
    from galewood.pipeline.reduction.oscillators import Exposure

PLACE_COUNT = 16
FIELD_COUNT, FIELD_SAMPLES, FIELD_SEED = 6, 100, 4
"""Crown fields, and their positions and headings, over which the covariance of the gusts is averaged."""
FIELD_M = 48.0
NUGGET = 1e-2
"""Share of the variance added to that of each place, so that places near each other are no difficulty."""
WEAK_INTENSITY = 1e-3
"""So weak that no gust is limited."""


@dataclass(frozen=True)
class Places:
    """G places (G, 3), m, and the gust at every node per unit of those at the places (n, G)."""

    place_m: Floats
    weight: Floats

    @property
    def count(self) -> int:
        """G."""
        return len(self.place_m)


def no_places(nodes: int) -> Places:
    """Of a body that feels one wind."""
    return Places(np.zeros((0, 3)), np.zeros((nodes, 0)))


def places_of(exposure: Exposure) -> Places:
    """Places of a crown: clusters of its nodes, weighted by the area with which they feel a steady wind."""
    area = exposure.area_m2 * exposure.share
    nodes = np.flatnonzero(area > 0)
    if not len(nodes) or not len(exposure.place_m):
        return no_places(len(exposure.area_m2))
    where = exposure.place_m[nodes]
    cluster = clusters(where, area[nodes], min(PLACE_COUNT, len(nodes)))
    members = [cluster == g for g in range(int(cluster.max()) + 1)]
    centres = np.array([np.average(where[m], axis=0, weights=area[nodes][m]) for m in members])
    place_m = np.asarray(centres.astype(np.float32), np.float64)  # as in the table
    weight = np.zeros((len(area), len(place_m)))
    weight[nodes] = _kriging(place_m, where)
    return Places(place_m, weight)


def _kriging(place_m: Floats, node_m: Floats) -> Floats:
    """(n, G) weights of the gusts at places (G, 3) in the estimate of those at nodes (n, 3)."""
    count = len(place_m)
    gusts = _sampled_gusts(np.concatenate([place_m, node_m]))
    among = gusts[:, :count].T @ gusts[:, :count]
    among += NUGGET * np.trace(among) / count * np.eye(count)
    return np.linalg.solve(among, gusts[:, :count].T @ gusts[:, count:]).T


def _sampled_gusts(place_m: Floats) -> Singles:
    """(samples, n) components along and across the wind of gusts at places (n, 3), for all headings."""
    rng, ones = np.random.default_rng(FIELD_SEED), np.ones(FIELD_SAMPLES)
    still, found = np.outer(ones, (1.0, 0.0)), list[Singles]()
    for seed in range(FIELD_COUNT):
        heading = rng.uniform(0, 2 * np.pi)
        c, s = np.cos(heading), np.sin(heading)
        x_m, z_m = rng.uniform(0, FIELD_M, (2, FIELD_SAMPLES))
        out = np.zeros((FIELD_SAMPLES, 2 * len(place_m)))
        wind = (c * ones, s * ones)
        write_gusts(
            crown_field(seed), (c, s, 0.0, WEAK_INTENSITY), place_m, (x_m, z_m), still, ones, wind, 2.0, out
        )
        found += [out[:, ::2].astype(np.float32), out[:, 1::2].astype(np.float32)]
    return np.concatenate(found)
