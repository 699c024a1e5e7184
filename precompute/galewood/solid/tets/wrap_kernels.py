"""Compiled kernels for wrapping: distances near the triangles, winding numbers, inscribed balls."""

from __future__ import annotations

import numba
import numpy as np

OPPOSING_COSINE = -0.4  # cosine threshold: only opposing faces bound the ball at a point


@numba.njit(cache=True, nogil=True)
def _point_triangle(px, py, pz, t):  # type: ignore[no-untyped-def]
    """Squared distance from a point to a triangle (3, 3).

    Source: Ericson 2005, Real-Time Collision Detection, 5.1.5.
    """
    abx, aby, abz = t[1, 0] - t[0, 0], t[1, 1] - t[0, 1], t[1, 2] - t[0, 2]
    acx, acy, acz = t[2, 0] - t[0, 0], t[2, 1] - t[0, 1], t[2, 2] - t[0, 2]
    apx, apy, apz = px - t[0, 0], py - t[0, 1], pz - t[0, 2]
    d1, d2 = abx * apx + aby * apy + abz * apz, acx * apx + acy * apy + acz * apz
    bpx, bpy, bpz = px - t[1, 0], py - t[1, 1], pz - t[1, 2]
    d3, d4 = abx * bpx + aby * bpy + abz * bpz, acx * bpx + acy * bpy + acz * bpz
    cpx, cpy, cpz = px - t[2, 0], py - t[2, 1], pz - t[2, 2]
    d5, d6 = abx * cpx + aby * cpy + abz * cpz, acx * cpx + acy * cpy + acz * cpz
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    if d1 <= 0 and d2 <= 0:
        v, w = 0.0, 0.0
    elif d3 >= 0 and d4 <= d3:
        v, w = 1.0, 0.0
    elif d6 >= 0 and d5 <= d6:
        v, w = 0.0, 1.0
    elif vc <= 0 and d1 >= 0 and d3 <= 0:
        v, w = d1 / (d1 - d3), 0.0
    elif vb <= 0 and d2 >= 0 and d6 <= 0:
        v, w = 0.0, d2 / (d2 - d6)
    elif va <= 0 and d4 - d3 >= 0 and d5 - d6 >= 0:
        w = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        v = 1.0 - w
    else:
        total = va + vb + vc
        if total <= 0:
            v, w = 0.0, 0.0
        else:
            v, w = vb / total, vc / total
    dx, dy, dz = apx - v * abx - w * acx, apy - v * aby - w * acy, apz - v * abz - w * acz
    return dx * dx + dy * dy + dz * dz


@numba.njit(cache=True, nogil=True)
def band_squares(triangles, shape, band):  # type: ignore[no-untyped-def]
    """Squared distance from each grid point to triangles (m, 3, 3), all in cells, at most `band` squared."""
    field = np.full(shape, np.float32(band * band))
    for f in range(len(triangles)):
        t = triangles[f]
        lo, hi = np.empty(3, np.int64), np.empty(3, np.int64)
        for k in range(3):
            lo[k] = max(0, int(np.floor(min(t[0, k], t[1, k], t[2, k]) - band)))
            hi[k] = min(shape[k] - 1, int(np.ceil(max(t[0, k], t[1, k], t[2, k]) + band)))
        for i in range(lo[0], hi[0] + 1):
            for j in range(lo[1], hi[1] + 1):
                for k in range(lo[2], hi[2] + 1):
                    square = _point_triangle(float(i), float(j), float(k), t)
                    if square < field[i, j, k]:
                        field[i, j, k] = square
    return field


@numba.njit(cache=True, nogil=True)
def vote(triangles, axis, jitter, votes):  # type: ignore[no-untyped-def]
    """Add 1 to the votes of all grid points inside, by the triangles (m, 3, 3) crossed along `axis`.

    Overlapping closed components add up, so a point is inside their union if its winding number is not zero.
    `jitter` (2,) moves the rays in the two other axes. Rays that meet no triangle cost nothing.
    """
    one, two = (axis + 1) % 3, (axis + 2) % 3  # a cyclic permutation preserves the winding
    wide, high, deep = votes.shape[one], votes.shape[two], votes.shape[axis]
    stride = (votes.shape[1] * votes.shape[2], votes.shape[2], 1)
    flat = votes.reshape(-1)
    change = np.zeros((wide, high, deep + 1), np.int16)
    met = np.zeros((wide, high), np.bool_)
    for f in range(len(triangles)):
        ax, ay, az = triangles[f, 0, one] + jitter[0], triangles[f, 0, two] + jitter[1], triangles[f, 0, axis]
        bx, by, bz = triangles[f, 1, one] + jitter[0], triangles[f, 1, two] + jitter[1], triangles[f, 1, axis]
        cx, cy, cz = triangles[f, 2, one] + jitter[0], triangles[f, 2, two] + jitter[1], triangles[f, 2, axis]
        area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
        if area == 0.0:
            continue
        x0, x1 = min(ax, bx, cx), max(ax, bx, cx)
        y0, y1 = min(ay, by, cy), max(ay, by, cy)
        for i in range(max(0, int(np.ceil(x0))), min(wide - 1, int(np.floor(x1))) + 1):
            for j in range(max(0, int(np.ceil(y0))), min(high - 1, int(np.floor(y1))) + 1):
                u = ((bx - i) * (cy - j) - (cx - i) * (by - j)) / area
                v = ((cx - i) * (ay - j) - (ax - i) * (cy - j)) / area
                w = 1.0 - u - v
                if u < 0 or v < 0 or w < 0:
                    continue
                k = min(max(int(np.ceil(u * az + v * bz + w * cz)), 0), deep)
                change[i, j, k] += -1 if area > 0 else 1
                met[i, j] = True
    for i in range(wide):
        for j in range(high):
            if not met[i, j]:
                continue
            at = i * stride[one] + j * stride[two]
            total = 0
            for k in range(deep):
                total += change[i, j, k]
                if total != 0:
                    flat[at + k * stride[axis]] += 1


@numba.njit(cache=True, nogil=True)
def signed(square, votes):  # type: ignore[no-untyped-def]
    """Replace squared distances by distances, negative where at least two rays voted for inside."""
    values, inside = square.reshape(-1), votes.reshape(-1)
    far, root = np.float32(-1.0), np.float32(0.0)
    for n in range(len(values)):
        if values[n] != far:  # most points lie outside the band and have the same value
            far = values[n]
            root = np.sqrt(far)
        values[n] = -root if inside[n] >= 2 else root


@numba.njit(cache=True, nogil=True)
def _cell_range(t, low, cell, shape):  # type: ignore[no-untyped-def]
    lo, hi = np.empty(3, np.int64), np.empty(3, np.int64)
    for k in range(3):
        lo[k] = max(0, int((min(t[0, k], t[1, k], t[2, k]) - low[k]) / cell))
        hi[k] = min(shape[k] - 1, int((max(t[0, k], t[1, k], t[2, k]) - low[k]) / cell))
    return lo, hi


@numba.njit(cache=True, nogil=True)
def triangle_grid(triangles, low, cell, shape):  # type: ignore[no-untyped-def]
    """Bucket grid of triangles by bounding box: offsets (cells + 1,) and items."""
    offsets = np.zeros(shape[0] * shape[1] * shape[2] + 1, np.int64)
    items = np.empty(0, np.int32)
    for phase in range(2):
        for f in range(len(triangles)):
            lo, hi = _cell_range(triangles[f], low, cell, shape)
            for i in range(lo[0], hi[0] + 1):
                for j in range(lo[1], hi[1] + 1):
                    for k in range(lo[2], hi[2] + 1):
                        c = (i * shape[1] + j) * shape[2] + k
                        if phase == 0:
                            offsets[c + 1] += 1
                        else:
                            items[offsets[c]] = f
                            offsets[c] += 1
        if phase == 0:
            offsets = np.cumsum(offsets)
            items = np.empty(offsets[-1], np.int32)
    offsets[1:] = offsets[:-1].copy()
    offsets[0] = 0
    return offsets, items


@numba.njit(cache=True, nogil=True)
def inner_balls(points, normals, face, piece, face_normals, triangles, grid, limit):  # type: ignore[no-untyped-def]
    """Radius of the largest ball (at most `limit`) that touches each point from inside its component.

    Only opposing faces count. Otherwise the ball at the edge of a facet would be limited by the next facet of
    the same round branch, and one near the end of a branch by its cap.
    """
    low, cell, shape, offsets, items = grid
    radius = np.empty(len(points))
    for p in range(len(points)):
        r = limit
        lo, hi = np.empty(3, np.int64), np.empty(3, np.int64)
        for k in range(3):
            centre = points[p, k] - limit * normals[p, k] - low[k]
            lo[k] = max(0, int((centre - limit) / cell))
            hi[k] = min(shape[k] - 1, int((centre + limit) / cell))
        for i in range(lo[0], hi[0] + 1):
            for j in range(lo[1], hi[1] + 1):
                for k in range(lo[2], hi[2] + 1):
                    c = (i * shape[1] + j) * shape[2] + k
                    for n in range(offsets[c], offsets[c + 1]):
                        f = items[n]
                        if (
                            piece[f] == piece[face[p]]
                            and np.dot(face_normals[f], normals[p]) < OPPOSING_COSINE
                        ):
                            r = _touching_radius(points[p], normals[p], triangles[f], r)
        radius[p] = r
    return radius


@numba.njit(cache=True, nogil=True)
def _ball_intersects(point, normal, r, t):  # type: ignore[no-untyped-def]
    """Whether the ball of radius r that touches `point` from inside intersects the triangle."""
    x, y, z = point[0] - r * normal[0], point[1] - r * normal[1], point[2] - r * normal[2]
    return _point_triangle(x, y, z, t) < r * r * (1 - 1e-6)


@numba.njit(cache=True, nogil=True)
def _touching_radius(point, normal, t, r):  # type: ignore[no-untyped-def]
    """Radius, at most r, of the ball through `point` that touches the triangle, by bisection."""
    if not _ball_intersects(point, normal, r, t):
        return r
    lo, hi = 0.0, r
    for _ in range(16):
        mid = 0.5 * (lo + hi)
        if _ball_intersects(point, normal, mid, t):
            hi = mid
        else:
            lo = mid
    return 0.5 * (lo + hi)
