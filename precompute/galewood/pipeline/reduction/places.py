"""Places of a crown: where the modal model takes the gusts, and the gust at every node estimated from theirs.

The gust at a node is estimated from those at the places by kriging: the linear estimate with the smallest
mean square error, for the crown field of `motion.wind.crown` in any wind direction. The estimate for a node
between the places is weaker than the gust there, as it should be: what the places do not know averages out.

The places are chosen one after the other, each where it adds most to the estimate of the forces on the first
natural modes (orthogonal least squares: Chen, Cowan and Grant, IEEE Transactions on Neural Networks 2, 1991,
302–309). Then each in turn moves to where it adds most beside the others, until none moves. Clusters of the
crown's area leave nearly twice the error (docs/design/0020-gusts.md).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from galewood.motion.wind import crown_field, write_gusts
from galewood.pipeline.sampling import CROWN_FIELD_M
from galewood.util import Array, Floats, Singles
from galewood.wood import BARE_EXPONENT

PLACE_COUNT = 32
MODE_COUNT = 30
"""Natural modes whose forces the places shall give."""
CANDIDATE_COUNT = 500
"""Nodes that the places are chosen from: every k-th one, at least so many and fewer than twice as many."""
LEAST_NEWS = 0.05
"""A place must add at least this share of its variance to what the other places know."""
EXCHANGE_ROUNDS = 20
"""Most rounds in which each place moves once; 3 to 8 are needed."""
LEAST_GAIN = 1e-6
"""Relative gain for which a place moves, above rounding, so that two equal ones do not take turns."""
FIELD_COUNT, FIELD_SAMPLES, FIELD_SEED = 8, 150, 4
"""Crown fields, and their positions and headings, over which the covariance of the gusts is averaged."""
NUGGET_SHARE = 1e-2
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


def places_of(area_m2: Floats, place_m: Floats, shapes: Floats, omega: Floats) -> Places:
    """Places of a crown whose nodes (n, 3), m, feel a steady wind with these areas (n,).

    ``shapes`` (k, 3n) and ``omega`` (k,), 1/s, are its natural modes.
    """
    nodes = np.flatnonzero(area_m2 > 0)
    if not len(nodes) or not len(place_m):
        return no_places(len(area_m2))
    gusts = _sampled_gusts(place_m[nodes])
    sideways = shapes[:MODE_COUNT].reshape(-1, len(area_m2), 3)[:, nodes][:, :, [0, 2]]
    # how far gusts move the nodes in each mode, about
    reach = np.sqrt(np.square(shapes[:MODE_COUNT]).mean(axis=1)) / omega[:MODE_COUNT]
    loads = area_m2[nodes][:, None, None] * sideways.transpose(1, 0, 2) * reach[:, None]
    forces = gusts @ loads.reshape(len(nodes), -1).astype(np.float32)
    candidates = np.arange(0, len(nodes), max(1, len(nodes) // CANDIDATE_COUNT))
    chosen = candidates[most_telling(gusts[:, candidates], forces, min(PLACE_COUNT, len(candidates)))]
    weight = np.zeros((len(area_m2), len(chosen)))
    weight[nodes] = _kriging(gusts, chosen)
    return Places(np.asarray(place_m[nodes[chosen]].astype(np.float32), np.float64), weight)


def most_telling(gusts: Singles, forces: Singles, count: int) -> list[int]:
    """The gusts (samples, n) from which the forces (samples, m) are estimated best, at most ``count``."""
    single = gusts.astype(np.float64)
    among, with_forces = single.T @ single, single.T @ forces
    chosen: list[int] = []
    while len(chosen) < count:
        gain = _gains(among, with_forces, chosen)
        best = int(np.argmax(gain))
        if gain[best] < 0:
            break
        chosen.append(best)
    for _ in range(EXCHANGE_ROUNDS):
        before = list(chosen)
        for k, present in enumerate(before):
            gain = _gains(among, with_forces, chosen[:k] + chosen[k + 1 :])
            best = int(np.argmax(gain))
            if gain[best] > max(0.0, (1.0 + LEAST_GAIN) * gain[present]):
                chosen[k] = best
        if chosen == before:
            break
    return chosen


def _gains(among: Floats, with_forces: Floats, chosen: list[int]) -> Floats:
    """(n,) how much more of the forces (squared) each gust explains beside the chosen ones.

    ``among`` (n, n) and ``with_forces`` (n, m) are the products of the gusts with each other and with the
    forces. −1 where a gust adds too little to what the chosen ones know of it.
    """
    own = np.diagonal(among)
    news, left = own, with_forces
    if chosen:
        weight = np.linalg.solve(among[np.ix_(chosen, chosen)], among[chosen])
        news = own - np.einsum("kn,kn->n", weight, among[chosen])
        left = with_forces - weight.T @ with_forces[chosen]
    known = news <= LEAST_NEWS * own
    return np.where(known, -1.0, np.square(left).sum(axis=1) / np.where(known, 1.0, news))


def _kriging(gusts: Singles, chosen: Array) -> Floats:
    """(n, G) weights of the chosen ones of gusts (samples, n) in the estimates of all."""
    own = gusts[:, chosen].astype(np.float64)
    among = own.T @ own
    among += NUGGET_SHARE * np.trace(among) / len(chosen) * np.eye(len(chosen))
    return np.linalg.solve(among, own.T @ gusts).T


def _sampled_gusts(place_m: Floats) -> Singles:
    """(samples, n) components along and across the wind of gusts at places (n, 3), for all headings."""
    rng, ones = np.random.default_rng(FIELD_SEED), np.ones(FIELD_SAMPLES)
    found: list[Singles] = []
    for seed in range(FIELD_COUNT):
        x_m, z_m = rng.uniform(0, CROWN_FIELD_M, (2, FIELD_SAMPLES))
        yaw_rad = rng.uniform(0, 2 * np.pi, FIELD_SAMPLES)
        turn = np.stack([np.cos(yaw_rad), np.sin(yaw_rad)], axis=1)
        out = np.zeros((FIELD_SAMPLES, 2 * len(place_m)))
        carried, wind = (1.0, 0.0, 0.0, WEAK_INTENSITY), (ones, 0.0 * ones)
        write_gusts(crown_field(seed), carried, place_m, (x_m, z_m), turn, ones, wind, BARE_EXPONENT, out)
        found += [out[:, ::2].astype(np.float32), out[:, 1::2].astype(np.float32)]
    return np.concatenate(found)
