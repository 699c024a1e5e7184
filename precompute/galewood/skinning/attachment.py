"""What bears twigs and leaves: points of wood and twigs, each with the place on the axis that holds it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from galewood.mesh import RenderPrimitive
from galewood.model.axis import Axis, Feet, chosen, joined
from galewood.util import Floats, Ints

MOST_PER_EDGE = 64


class Bearers:
    """Vertices and points on the edges of the wood and the twigs added so far."""

    def __init__(self, axis: Axis, step_m: float) -> None:
        """``step_m``: largest distance between points on an edge."""
        self._axis, self._step_m = axis, step_m
        self._points: list[Floats] = []
        self._feet: list[Feet] = []

    def add(self, primitive: RenderPrimitive, feet: Feet) -> None:
        """Add a primitive whose vertices (n,) are held at ``feet``."""
        points = edge_points(primitive, self._step_m)
        self._points.append(points.place_m)
        self._feet.append(_between(points, feet, primitive.kind == "wood"))

    def distance_m(self, points_m: Floats) -> Floats:
        """(s,) distance of points (s, 3) from the nearest point that bears."""
        return np.asarray(KDTree(np.concatenate(self._points)).query(points_m)[0], dtype=np.float64)

    def nearest(self, points_m: Floats, piece: Ints) -> Feet:
        """For each piece (k,), the place that holds what is nearest to its points (s, 3), with the distance.

        ``piece`` (s,) is the number of each point's piece, 0 … k − 1.
        """
        distance, near = KDTree(np.concatenate(self._points)).query(points_m)
        order = np.lexsort((distance, piece))
        _, first = np.unique(piece[order], return_index=True)
        at = order[first]
        held = chosen(joined(self._feet), np.asarray(near, np.int64)[at])
        again = self._axis.feet(held.at_m)
        own = held.child < 0
        return Feet(
            np.where(own, again.child, held.child),
            np.where(own, again.share, held.share),
            np.where(own[:, None], again.at_m, held.at_m),
            np.asarray(distance, np.float64)[at],
        )


def _between(points: EdgePoints, feet: Feet, wood: bool) -> Feet:
    """Places that hold points on edges: of a twig its own; of wood between those of the ends, child −1."""
    first, second = points.ends.T
    if not wood:
        return chosen(feet, first)
    share = points.share[:, None]
    at_m = (1 - share) * feet.at_m[first] + share * feet.at_m[second]
    return Feet(np.full(len(first), -1, np.int64), np.zeros(len(first)), at_m, feet.distance_m[first])


@dataclass(frozen=True)
class EdgePoints:
    """Points (s, 3) between two vertices (s, 2) of the same piece, ``share`` (s,) of the way."""

    place_m: Floats
    ends: Ints
    share: Floats


def edge_points(primitive: RenderPrimitive, step_m: float) -> EdgePoints:
    """All vertices, and points on the edges that are longer than step_m."""
    place, faces = primitive.positions_m, primitive.faces
    ends = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    ends = np.unique(np.sort(ends, axis=1), axis=0)
    length = np.linalg.norm(place[ends[:, 1]] - place[ends[:, 0]], axis=1)
    inner = np.clip(np.ceil(length / step_m).astype(np.int64) - 1, 0, MOST_PER_EDGE)
    edge = np.repeat(np.arange(len(ends)), inner)
    within = np.arange(len(edge)) - np.repeat(np.cumsum(inner) - inner, inner)
    share = np.concatenate([np.zeros(len(place)), (within + 1) / (inner[edge] + 1)])
    own = np.arange(len(place))
    both = np.concatenate([np.column_stack([own, own]), ends[edge]])
    return EdgePoints(
        (1 - share[:, None]) * place[both[:, 0]] + share[:, None] * place[both[:, 1]], both, share
    )
