"""Leaves that are copies of a few: the same shape, moved, turned and scaled."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from galewood.io.export.engine.pieces import leaf_pieces
from galewood.util import Floats, Ints

Coordinates = npt.NDArray[np.floating[Any]]
ALIKE_SHARE = 1e-3
"""Copies differ from what they are copies of by less than this share of their size."""
FEWEST_COPIES = 8
"""A shape of fewer leaves stays in the mesh."""
UV_STEPS = 1e4
"""Texture coordinates are the same up to a part of this many."""


@dataclass(frozen=True)
class Copies:
    """A shape and the leaves that are copies of it."""

    shape_m: Floats
    """(k, 3) vertices about their centre."""
    faces: Ints
    """(f, 3) triangles of these."""
    vertices: Ints
    """(n, k) vertices of each leaf, in the same order."""
    place_m: Floats
    """(n, 3) centre of each leaf."""
    turn: Floats
    """(n, 3, 3) its rotation."""
    scale: Floats
    """(n,)"""


def copies_of(rest_m: Floats, faces: Ints, uv: Coordinates | None) -> list[Copies]:
    """The shapes of which there are copies.

    A leaf is a connected piece of the mesh. Leaves with the same triangles and texture coordinates are
    compared with the first of them, those that are not alike with the first of the rest, and so on.

    Args:
        rest_m: (v, 3) vertices of the leaves.
        faces: (f, 3) triangles.
        uv: (v, 2) texture coordinates, if there are any.
    """
    found = list[Copies]()
    for vertices, triangles in _families(leaf_pieces(rest_m, faces).of_vertex, faces, uv):
        left = vertices
        while len(left) >= FEWEST_COPIES:
            arm = rest_m[left] - rest_m[left].mean(axis=1, keepdims=True)
            turn, scale = _similarity(arm[0], arm)
            off = np.linalg.norm(arm - scale[:, None, None] * (arm[0] @ turn.transpose(0, 2, 1)), axis=2)
            alike = off.max(axis=1) <= ALIKE_SHARE * np.linalg.norm(arm, axis=2).max(axis=1)
            alike[0] = True
            if alike.sum() >= FEWEST_COPIES:
                place = rest_m[left[alike]].mean(axis=1)
                found.append(Copies(arm[0], triangles, left[alike], place, turn[alike], scale[alike]))
            left = left[~alike]
    return found


def _families(piece: Ints, faces: Ints, uv: Coordinates | None) -> list[tuple[Ints, Ints]]:
    """Vertices (n, k) and triangles (f, 3) of leaves that agree in triangles and texture coordinates."""
    order = np.argsort(piece, kind="stable")
    first = np.flatnonzero(np.r_[True, np.diff(piece[order]) > 0])
    place = np.empty(len(piece), np.int64)
    place[order] = np.arange(len(piece)) - np.repeat(first, np.diff(np.r_[first, len(piece)]))
    own = np.argsort(piece[faces[:, 0]], kind="stable")
    starts = np.searchsorted(piece[faces[own, 0]], np.arange(len(first) + 1))
    marks = np.zeros((len(piece), 2), np.int64) if uv is None else np.rint(uv * UV_STEPS).astype(np.int64)
    families = dict[bytes, tuple[list[Ints], Ints]]()
    for number, vertices in enumerate(np.split(order, first[1:])):
        triangles = place[faces[own[starts[number] : starts[number + 1]]]]
        key = b"|".join((triangles.tobytes(), marks[vertices].tobytes()))
        families.setdefault(key, ([], triangles))[0].append(vertices)
    return [(np.stack(members), triangles) for members, triangles in families.values()]


def _similarity(shape: Floats, arm: Floats) -> tuple[Floats, Floats]:
    """Rotations (n, 3, 3) and scales (n,) that bring a shape (k, 3) nearest to arms (n, k, 3).

    Umeyama, Least-squares estimation of transformation parameters between two point patterns (1991).
    """
    left, size, right = np.linalg.svd(np.einsum("nki,kj->nij", arm, shape))
    signs = np.ones((len(arm), 3))
    signs[:, 2] = np.sign(np.linalg.det(left @ right))
    turn = (left * signs[:, None]) @ right
    return turn, (size * signs).sum(axis=1) / max(float(np.square(shape).sum()), 1e-30)
