"""Horizontal sections of a closed surface, and points on its edges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from galewood.tree.repair import Surface, unique_edges
from galewood.util import Floats


@dataclass(frozen=True)
class Section:
    """One closed outline of a cut: its centre (3,) and the area inside."""

    centre: Floats
    area: float

    @property
    def radius(self) -> float:
        """Radius of the circle of the same area."""
        return float(np.sqrt(self.area / np.pi))


def sections_at(surface: Surface, height: float) -> list[Section]:
    """The outlines in which a horizontal plane cuts a closed surface (y up), the largest first."""
    above = surface.vertices[:, 1] > height
    cut = surface.faces[above[surface.faces].any(axis=1) & ~above[surface.faces].all(axis=1)]
    if not len(cut):
        return []
    edges = np.stack([cut, np.roll(cut, -1, axis=1)], axis=2)  # (m, 3, 2)
    upward = ~above[edges[..., 0]] & above[edges[..., 1]]
    downward = above[edges[..., 0]] & ~above[edges[..., 1]]
    ends = np.stack([edges[upward], edges[downward]])  # (2, m, 2): every face has one of each
    ordered = np.sort(ends.reshape(-1, 2), axis=1)
    _, label = np.unique(ordered, axis=0, return_inverse=True)
    label = label.reshape(2, -1)
    graph = coo_matrix((np.ones(len(cut)), (label[0], label[1])), shape=(label.max() + 1,) * 2)
    count, loop = connected_components(graph, directed=False)
    loop = loop[label[0]]
    first, second = (_crossing(surface, pair, height) for pair in ends)
    length = np.linalg.norm(second - first, axis=1)
    found: list[Section] = []
    for number in range(count):
        own = loop == number
        middle = np.average((first + second)[own] / 2, axis=0, weights=np.maximum(length[own], 1e-300))
        a, b = first[own] - middle, second[own] - middle
        area = abs(float((a[:, 0] * b[:, 2] - a[:, 2] * b[:, 0]).sum())) / 2
        found.append(Section(middle, area))
    return sorted(found, key=lambda section: -section.area)


def _crossing(surface: Surface, pair: np.ndarray, height: float) -> Floats:
    """Points (m, 3) in which edges (m, 2) cross a height."""
    low, high = surface.vertices[pair[:, 0]], surface.vertices[pair[:, 1]]
    share = (height - low[:, 1]) / (high[:, 1] - low[:, 1])
    return low + share[:, None] * (high - low)


def edge_samples(surface: Surface, step: float) -> Floats:
    """(s, 3) all vertices, and points at most ``step`` apart on all edges."""
    edges = unique_edges(surface.faces)
    start, end = surface.vertices[edges[:, 0]], surface.vertices[edges[:, 1]]
    pieces = np.clip(np.ceil(np.linalg.norm(end - start, axis=1) / step), 1, 200).astype(int)
    edge = np.repeat(np.arange(len(edges)), pieces - 1)
    first = np.repeat(np.cumsum(pieces - 1) - (pieces - 1), pieces - 1)
    share = ((np.arange(len(edge)) - first + 1) / pieces[edge])[:, None]
    return np.concatenate([surface.vertices, start[edge] + share * (end - start)[edge]])
