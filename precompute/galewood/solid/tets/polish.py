"""Improvement of the worst tetrahedra by moving their vertices."""

from __future__ import annotations

import numba
import numpy as np

from galewood.solid.tets.quality import boundary_faces, vertex_normals
from galewood.util import Floats, Ints

SWEEP_COUNT = 8
GOOD_SHAPE = 0.3
FIRST_STEP = 0.2  # of the mean length of the edges at the vertex; halved in every second sweep
DIRECTIONS = np.array(
    [[x, y, z] for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if (x, y, z) != (0, 0, 0)],
    dtype=np.float64,
)


def polished(vertices: Floats, tets: Ints, along_m: float, below: float = GOOD_SHAPE) -> Floats:
    """Vertices (n, 3) moved so that the worst tet at each of them has a better shape.

    Only vertices of a tet whose shape is less than `below` are moved.

    Vertices of the surface stay in their tangential plane, within `along_m` of where they were.
    """
    faces = boundary_faces(tets)
    normal, _ = vertex_normals(vertices, faces)
    on_surface = np.zeros(len(vertices), dtype=bool)
    on_surface[faces] = True
    around, skin = tets_of_vertices(tets, len(vertices)), (vertices, normal, on_surface)
    directions = DIRECTIONS / np.linalg.norm(DIRECTIONS, axis=1, keepdims=True)
    result = np.array(vertices, dtype=np.float64)
    for sweep in range(SWEEP_COUNT):
        step = FIRST_STEP * 0.5 ** (sweep // 2)
        moved = _sweep(result, tets, around, skin, directions, step, along_m, below)
        if not moved and sweep % 2 == 1 and sweep > 2:
            break
    return result


def tets_of_vertices(tets: Ints, count: int) -> tuple[Ints, Ints]:
    """Offsets (count + 1,) into items: the tets at each vertex."""
    items = np.argsort(tets.reshape(-1), kind="stable") // 4
    offsets = np.concatenate([[0], np.cumsum(np.bincount(tets.reshape(-1), minlength=count))])
    return offsets, items


@numba.njit(cache=True, nogil=True)
def _shape(p, q, r, s):  # type: ignore[no-untyped-def]
    """Shape of a tet, 6√2 V / l_rms³: 1 for a regular tet, negative if it is inverted."""
    ax, ay, az = q[0] - p[0], q[1] - p[1], q[2] - p[2]
    bx, by, bz = r[0] - p[0], r[1] - p[1], r[2] - p[2]
    cx, cy, cz = s[0] - p[0], s[1] - p[1], s[2] - p[2]
    six = (ay * bz - az * by) * cx + (az * bx - ax * bz) * cy + (ax * by - ay * bx) * cz
    square = ax * ax + ay * ay + az * az + bx * bx + by * by + bz * bz + cx * cx + cy * cy + cz * cz
    square += (bx - ax) ** 2 + (by - ay) ** 2 + (bz - az) ** 2
    square += (cx - ax) ** 2 + (cy - ay) ** 2 + (cz - az) ** 2
    square += (cx - bx) ** 2 + (cy - by) ** 2 + (cz - bz) ** 2
    mean = square / 6.0
    return np.sqrt(2.0) * six / max(mean * np.sqrt(mean), 1e-300)


@numba.njit(cache=True, nogil=True)
def _worst(vertices, tets, items, start, end):  # type: ignore[no-untyped-def]
    worst = 2.0
    for n in range(start, end):
        t = tets[items[n]]
        worst = min(worst, _shape(vertices[t[0]], vertices[t[1]], vertices[t[2]], vertices[t[3]]))
    return worst


@numba.njit(cache=True, nogil=True)
def _sweep(vertices, tets, around, skin, directions, share, along, below):  # type: ignore[no-untyped-def]
    """Move every vertex with a bad tet to the best of the places around it; returns the number moved."""
    offsets, items = around
    before, normal, on_surface = skin
    moved = 0
    for v in range(len(vertices)):
        start, end = offsets[v], offsets[v + 1]
        best = _worst(vertices, tets, items, start, end)
        if best > below:
            continue
        place = vertices[v].copy()
        length = 0.0
        for n in range(start, end):
            for k in range(4):
                length += np.sqrt(((vertices[tets[items[n], k]] - place) ** 2).sum())
        step = share * length / (3 * (end - start))
        chosen = place.copy()
        for d in range(len(directions)):
            for half in range(2):
                target = place + directions[d] * (step * (1.0 - 0.5 * half))
                if on_surface[v]:
                    gap = target - before[v]
                    target -= np.dot(gap, normal[v]) * normal[v]
                    if ((target - before[v]) ** 2).sum() > along * along:
                        continue
                vertices[v] = target
                worst = _worst(vertices, tets, items, start, end)
                if worst > best + 1e-4:
                    best = worst
                    chosen[:] = target
        vertices[v] = chosen
        if (chosen != place).any():
            moved += 1
    return moved
