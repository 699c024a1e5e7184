"""Distortion of a skinned tree in far poses: stretch of edges, gaps at attachments."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import KDTree

from galewood.solid.skinning.attachment import PIECE_SAMPLES, SUPPORT_SAMPLES, edge_samples
from galewood.solid.skinning.embedding import foliage_pieces
from galewood.solid.skinning.node_poses import SkinLike, drawn_positions
from galewood.tree import RenderPrimitive, TreeMesh, unique_edges
from galewood.util import Floats, Ints

FIGURE_SWAY = 0.2
"""Displacement of the top over the height at which the figures are taken."""
HEADING_COUNT = 8
SHORTEST_EDGE_M = 0.005
"""Shorter edges are not measured: nobody sees them."""
MOST_STRETCH = 1.3
"""Length of an edge of the wood, relative to rest, beyond which a tree looks torn."""
TYPICAL_PERCENTILE, WORST_PERCENTILE = 99.9, 100.0
COMPARED_SUPPORTS = 16
"""Nearest samples of wood and twigs that are compared with a sample of a leaf."""
TOUCH_DISTANCE = 0.003
"""A piece touches what is at most this much farther away than what is nearest, relative to the height."""
DETACHED_DISTANCE = 0.01
"""A piece that is farther from all drawn wood, relative to the height, may hang on wood that is not drawn."""


def farthest_poses(q: Floats, top: Floats, sway_m: float) -> Floats:
    """(k, f) the pose of the farthest sway towards each of several headings, scaled to the same sway, m.

    ``q`` (T, f) are the poses to choose from, ``top`` (3, f) the displacement of the tree's top, m, per unit
    of each coordinate.
    """
    moved = q @ top.T
    sway = np.linalg.norm(moved, axis=1)
    heading = (
        np.floor((np.arctan2(moved[:, 2], moved[:, 0]) / (2 * np.pi) + 1) * HEADING_COUNT) % HEADING_COUNT
    )
    poses: list[Floats] = [np.zeros((0, q.shape[1]))]
    for number in range(HEADING_COUNT):
        own = np.flatnonzero((heading == number) & (sway > 1e-9))
        if len(own):
            far = int(own[sway[own].argmax()])
            poses.append(q[far : far + 1] * (sway_m / sway[far]))
    return np.concatenate(poses)


class Distortion:
    """Measures the distortion of a tree's tables; what depends on the mesh alone is computed once."""

    def __init__(self, tree: TreeMesh) -> None:
        """``tree``: the drawn mesh."""
        self._tree = tree

    @property
    def tree(self) -> TreeMesh:
        """The drawn mesh."""
        return self._tree

    @cached_property
    def rest_m(self) -> Floats:
        """(v, 3) the vertices at rest."""
        return np.concatenate([p.positions_m for p in self._tree.primitives])

    @cached_property
    def wood(self) -> Ints:
        """(w,) the vertices of the wood."""
        kinds = [p.kind == "wood" for p in self._tree.primitives]
        return np.flatnonzero(np.repeat(kinds, [len(p.positions_m) for p in self._tree.primitives]))

    @cached_property
    def _edges(self) -> _Edges:
        return _Edges(self._tree, self.rest_m)

    @cached_property
    def contacts(self) -> list[tuple[str, Contacts]]:
        """What the pieces of each primitive of twigs and leaves attach to, with its kind; twigs first."""
        return _contacts(self._tree)

    def in_poses(self, skin: SkinLike, poses: Floats, gaps: bool = True) -> dict[str, float]:
        """The largest figures of a skin in some poses (k, r).

        ``stretch``: length of an edge over its length at rest (99.9th percentile, and the worst), of wood,
        twigs and leaves; ``gap``: distance by which a twig or leaf leaves what it hangs on, over the height.
        """
        worst: dict[str, float] = {"sway": FIGURE_SWAY}
        for pose in poses:
            now_m = drawn_positions(skin, self.rest_m, pose)
            figures = self.between(self.rest_m, now_m) if gaps else self._edges.figures(self.rest_m, now_m)
            for name, value in figures.items():
                worst[name] = max(worst.get(name, 0.0), round(value, 5))
        return worst

    def far_poses(self, skin: SkinLike, q: Sequence[Floats]) -> Floats:
        """The poses (k, r) of the farthest sways in training runs q (T, f), scaled to the same sway."""
        every = np.concatenate(q)
        modes = every.shape[1]
        top = skin.node_basis[int(skin.node_rest_m[:, 1].argmax()), :, :modes].astype(np.float64)
        poses = farthest_poses(every, top, FIGURE_SWAY * self._tree.height_m)
        return np.pad(poses, ((0, 0), (0, skin.node_basis.shape[2] - modes)))

    def gaps(self, skin: SkinLike, contacts: Contacts, poses: Floats) -> Floats:
        """(p,) the largest gap of each piece in some poses (k, r), over the height."""
        found = [contacts.gaps_m(self.rest_m, drawn_positions(skin, self.rest_m, pose)) for pose in poses]
        return np.array(found).max(axis=0, initial=0.0) / self._tree.height_m

    def between(self, rest_m: Floats, now_m: Floats) -> dict[str, float]:
        """The figures of one pose, from the positions of the vertices (v, 3) at rest and now."""
        figures = self._edges.figures(rest_m, now_m)
        for kind, contacts in self.contacts:
            gap = float(contacts.gaps_m(rest_m, now_m).max()) / self._tree.height_m
            figures[f"{kind}_gap"] = max(gap, figures.get(f"{kind}_gap", 0.0))
        return figures


def is_torn(figures: Mapping[str, float]) -> bool:
    """Whether the figures of ``Distortion.in_poses`` are those of a tree that looks torn."""
    return figures.get("wood_stretch_worst", 1.0) > MOST_STRETCH


def stretch_words(figures: Mapping[str, float]) -> str:
    """How far a torn table stretches the wood, in words."""
    return (
        f"stretches edges of the wood to {figures['wood_stretch_worst']:.2f} times their length "
        f"({figures['wood_stretch']:.2f} for 99.9 % of them)"
    )


def distortion_line(figures: Mapping[str, float]) -> str:
    """The figures of ``Distortion.in_poses`` in one line for a reader; empty if there are none."""
    if "wood_stretch" not in figures:
        return ""
    typical, worst = figures["wood_stretch"], figures["wood_stretch_worst"]
    gaps = [figures[name] for name in ("twigs_gap", "leaves_gap") if name in figures]
    near = f", leaves and twigs within {max(gaps):.2%} of the height of their place" if gaps else ""
    return (
        f"drawn at {figures['sway']:.0%} sway, in a storm and pulled: wood edges at most {worst:.2f} times "
        f"as long ({typical:.2f} for 99.9 %){near}"
    )


class _Edges:
    """Edges of all primitives by kind."""

    def __init__(self, tree: TreeMesh, rest_m: Floats) -> None:
        first, found = 0, dict[str, list[Ints]]()
        for primitive in tree.primitives:
            found.setdefault(primitive.kind, []).append(unique_edges(primitive.faces) + first)
            first += len(primitive.positions_m)
        self._edges: dict[str, Ints] = {}
        for kind, parts in found.items():
            edges = np.concatenate(parts)
            length = np.linalg.norm(rest_m[edges[:, 0]] - rest_m[edges[:, 1]], axis=1)
            self._edges[kind] = edges[length > SHORTEST_EDGE_M]

    def figures(self, rest_m: Floats, now_m: Floats) -> dict[str, float]:
        """Stretch of the edges between two positions of the vertices (v, 3)."""
        figures: dict[str, float] = {}
        for kind, edges in self._edges.items():
            if not len(edges):
                continue
            before, after = (np.linalg.norm(x[edges[:, 0]] - x[edges[:, 1]], axis=1) for x in (rest_m, now_m))
            ratio = after / before
            figures[f"{kind}_stretch"] = float(np.percentile(ratio, TYPICAL_PERCENTILE))
            figures[f"{kind}_stretch_worst"] = float(np.percentile(ratio, WORST_PERCENTILE))
        return figures


@dataclass(frozen=True)
class Contacts:
    """Samples of the edges of pieces beside those of their supports: c pairs of points on edges."""

    piece: Ints  # (c,)
    ends: Ints  # (c, 2) vertices between which the piece's point lies
    share: Floats  # (c,) share of the second
    support_ends: Ints  # (c, 2) the same of the support's point
    support_share: Floats  # (c,)
    of_vertex: Ints  # (n,) piece of each vertex of the primitive
    first: int  # number of its first vertex

    def vertices(self, piece: int) -> Ints:
        """The vertices of a piece."""
        return self.first + np.flatnonzero(self.of_vertex == piece)

    def distance_m(self, place_m: Floats) -> Floats:
        """(c,) distance of each pair, for vertices at place_m (v, 3)."""
        own = _between(place_m, self.ends, self.share)
        return np.linalg.norm(own - _between(place_m, self.support_ends, self.support_share), axis=1)

    def gaps_m(self, rest_m: Floats, now_m: Floats) -> Floats:
        """(p,) distance by which each piece has moved from or into all that it touches."""
        change = np.abs(self.distance_m(now_m) - self.distance_m(rest_m))
        least = np.full(int(self.piece.max()) + 1, np.inf)
        np.minimum.at(least, self.piece, change)
        return np.where(np.isfinite(least), least, 0.0)


def _contacts(tree: TreeMesh) -> list[tuple[str, Contacts]]:
    """Contacts of each primitive of twigs with wood, and of each of leaves with wood or twigs.

    A piece hangs on what it is nearest to. If it touches several, it hangs on the one that it follows. One
    that hangs on wood that is not drawn, away from all that is, has nothing to leave a gap to.
    """
    starts = np.cumsum([0, *(len(p.positions_m) for p in tree.primitives)])[:-1].tolist()
    parts = [(p, first) for p, first in zip(tree.primitives, starts, strict=True) if len(p.faces)]
    found: list[tuple[str, Contacts]] = []
    for kind, supporting in (("twigs", ("wood",)), ("leaves", ("wood", "twigs"))):
        own = [part for part in parts if part[0].kind == kind]
        bearing = [part for part in parts if part[0].kind in supporting]
        if own and bearing:
            supports = _SupportEdges(bearing, tree.height_m, tree.added_wood())
            contacts = [(kind, supports.contacts(*part)) for part in own]
            found += [one for one in contacts if len(one[1].piece)]
    return found


class _SupportEdges:
    """Edges on which pieces hang, found by samples of them."""

    def __init__(
        self, parts: list[tuple[RenderPrimitive, int]], height_m: float, added: RenderPrimitive | None
    ) -> None:
        self._height_m, step_m = height_m, height_m / SUPPORT_SAMPLES
        self._added = KDTree(edge_samples(added, step_m).place_m) if added else None
        samples = [edge_samples(primitive, step_m) for primitive, _ in parts]
        self._ends = np.concatenate([s.ends + first for s, (_, first) in zip(samples, parts, strict=True)])
        self._share = np.concatenate([s.share for s in samples])
        self._tree = KDTree(np.concatenate([s.place_m for s in samples]))

    def contacts(self, primitive: RenderPrimitive, first: int) -> Contacts:
        """The pairs of the pieces of a primitive whose vertices begin at ``first``."""
        samples = edge_samples(primitive, self._height_m / PIECE_SAMPLES)
        count = min(COMPARED_SUPPORTS, len(self._ends))
        distance, near = (x.reshape(-1, count) for x in self._tree.query(samples.place_m, k=count))
        of_vertex = foliage_pieces(primitive)
        piece = of_vertex[samples.ends[:, 0]]
        least = np.full(int(piece.max()) + 1, np.inf)
        np.minimum.at(least, piece, distance[:, 0])
        least[self._on_added(samples.place_m, piece, least)] = -np.inf
        row, column = np.nonzero(distance <= least[piece][:, None] + TOUCH_DISTANCE * self._height_m)
        support = near[row, column]
        return Contacts(
            piece[row],
            samples.ends[row] + first,
            samples.share[row],
            self._ends[support],
            self._share[support],
            of_vertex,
            first,
        )

    def _on_added(self, place_m: Floats, piece: Ints, drawn_m: Floats) -> np.ndarray:
        """(k,) whether pieces hang on added wood, given their distance (k,) from what is drawn."""
        if self._added is None:
            return np.zeros(len(drawn_m), bool)
        least = np.full(len(drawn_m), np.inf)
        np.minimum.at(least, piece, self._added.query(place_m)[0])
        return (least < drawn_m) & (drawn_m > DETACHED_DISTANCE * self._height_m)


def _between(place_m: Floats, ends: Ints, share: Floats) -> Floats:
    return place_m[ends[:, 0]] * (1 - share[:, None]) + place_m[ends[:, 1]] * share[:, None]
