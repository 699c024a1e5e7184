"""What twigs and leaves attach to: points on wood and twigs, each with its binding."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from galewood.solid.skinning.axis import Axis
from galewood.solid.skinning.bindings import Bindings
from galewood.tree import RenderPrimitive, unique_edges
from galewood.util import Floats, Ints

SUPPORT_SAMPLES, PIECE_SAMPLES = 400, 200
"""Supports, and the pieces that attach to them, are sampled at these fractions of the height."""
MOST_SAMPLES_PER_EDGE = 64


@dataclass(frozen=True)
class EdgeSamples:
    """Points place_m (s, 3) between two vertices ``ends`` (s, 2) of a piece, ``share`` (s,) of the way."""

    place_m: Floats
    ends: Ints
    share: Floats


def edge_samples(primitive: RenderPrimitive, step_m: float) -> EdgeSamples:
    """All vertices, and points on the edges that are longer than step_m."""
    place = primitive.positions_m
    ends = unique_edges(primitive.faces)
    length = np.linalg.norm(place[ends[:, 1]] - place[ends[:, 0]], axis=1)
    inner = np.clip(np.ceil(length / step_m).astype(np.int64) - 1, 0, MOST_SAMPLES_PER_EDGE)
    edge = np.repeat(np.arange(len(ends)), inner)
    within = np.arange(len(edge)) - np.repeat(np.cumsum(inner) - inner, inner)
    share = np.concatenate([np.zeros(len(place)), (within + 1) / (inner[edge] + 1)])
    own = np.arange(len(place))
    both = np.concatenate([np.column_stack([own, own]), ends[edge]])
    return EdgeSamples(
        (1 - share[:, None]) * place[both[:, 0]] + share[:, None] * place[both[:, 1]], both, share
    )


class Supports:
    """Samples of the wood and the twigs added so far, to which pieces of twigs and leaves attach."""

    def __init__(self, axis: Axis, step_m: float) -> None:
        """``step_m``: largest distance between samples of an edge."""
        self._axis, self._step_m = axis, step_m
        self._points: list[Floats] = []
        self._bindings: list[Bindings] = []

    def add(self, primitive: RenderPrimitive, bindings: Bindings) -> None:
        """Add a primitive with the bindings of its vertices (n,)."""
        samples = edge_samples(primitive, self._step_m)
        self._points.append(samples.place_m)
        self._bindings.append(_sample_bindings(samples, bindings, primitive.kind == "wood"))

    def distance_m(self, points_m: Floats) -> Floats:
        """(s,) distance of points (s, 3) from the nearest sample."""
        return np.asarray(KDTree(np.concatenate(self._points)).query(points_m)[0], dtype=np.float64)

    def nearest(self, points_m: Floats, piece: Ints) -> Bindings:
        """For each piece (k,), the binding of the sample nearest to its points (s, 3), with the distance.

        ``piece`` (s,) is the number of each point's piece, 0 … k − 1.
        """
        distance, near = KDTree(np.concatenate(self._points)).query(points_m)
        order = np.lexsort((distance, piece))
        _, first = np.unique(piece[order], return_index=True)
        at = order[first]
        found = Bindings.concatenated(self._bindings).take(np.asarray(near, np.int64)[at])
        again = self._axis.nearest(found.at_m)
        unbound = found.child < 0
        return Bindings(
            np.where(unbound, again.child, found.child),
            np.where(unbound, again.share, found.share),
            np.where(unbound[:, None], again.at_m, found.at_m),
            np.asarray(distance, np.float64)[at],
        )


def _sample_bindings(samples: EdgeSamples, bindings: Bindings, wood: bool) -> Bindings:
    """Bindings of samples: on a twig those of its vertices; on wood a place between both ends, child −1."""
    first, second = samples.ends.T
    if not wood:
        return bindings.take(first)
    share = samples.share[:, None]
    at_m = (1 - share) * bindings.at_m[first] + share * bindings.at_m[second]
    unbound = np.full(len(first), -1, np.int64)
    return Bindings(unbound, np.zeros(len(first)), at_m, bindings.distance_m[first])
