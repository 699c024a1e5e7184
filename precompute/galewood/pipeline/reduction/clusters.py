"""Clusters of points by k-means."""

from __future__ import annotations

import numpy as np

from galewood.util import Array, Floats

ROUND_COUNT = 40


def clusters(places: Floats, weight: Floats, count: int) -> Array:
    """Cluster (n,) of each place (n, k): k-means (Lloyd), begun at places far from each other."""
    first = np.argmax(weight * np.square(places).sum(axis=1))
    centres = [places[first]]
    distance = np.square(places - centres[0]).sum(axis=1)
    for _ in range(count - 1):
        centres.append(places[np.argmax(weight * distance)])
        distance = np.minimum(distance, np.square(places - centres[-1]).sum(axis=1))
    centre, cluster = np.array(centres), np.zeros(len(places), np.int64)
    for _ in range(ROUND_COUNT):
        nearest = np.argmin([np.square(places - one).sum(axis=1) for one in centre], axis=0)
        if (nearest == cluster).all():
            break
        cluster = nearest
        for j in np.unique(cluster):
            centre[j] = np.average(places[cluster == j], axis=0, weights=weight[cluster == j])
    return np.unique(cluster, return_inverse=True)[1]
