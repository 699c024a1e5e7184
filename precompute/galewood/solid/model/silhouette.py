"""Wind-exposed area of a tree: its silhouette from the side, averaged over directions."""

from __future__ import annotations

import numba
import numpy as np

from galewood.util import Floats

DIRECTION_COUNT = 6
PIXELS_HIGH = 384


@numba.njit(cache=True, nogil=True)
def _draw(triangles, transparency, clear):  # type: ignore[no-untyped-def]
    """Multiply clear (h, w) by each triangle's transparency at the pixel centres it covers (pixel units)."""
    height, width = clear.shape
    for f in range(len(triangles)):
        t = triangles[f]
        area = (t[1, 0] - t[0, 0]) * (t[2, 1] - t[0, 1]) - (t[2, 0] - t[0, 0]) * (t[1, 1] - t[0, 1])
        if area == 0.0:
            continue
        x0, x1 = min(t[0, 0], t[1, 0], t[2, 0]), max(t[0, 0], t[1, 0], t[2, 0])
        y0, y1 = min(t[0, 1], t[1, 1], t[2, 1]), max(t[0, 1], t[1, 1], t[2, 1])
        for j in range(max(0, int(np.ceil(y0))), min(height - 1, int(np.floor(y1))) + 1):
            for i in range(max(0, int(np.ceil(x0))), min(width - 1, int(np.floor(x1))) + 1):
                u = ((t[1, 0] - i) * (t[2, 1] - j) - (t[2, 0] - i) * (t[1, 1] - j)) / area
                v = ((t[2, 0] - i) * (t[0, 1] - j) - (t[0, 0] - i) * (t[2, 1] - j)) / area
                if u >= 0 and v >= 0 and u + v <= 1:
                    clear[j, i] *= transparency[f]


def silhouette_area(triangles_m: Floats, coverage: Floats) -> float:
    """Mean frontal area, m², of triangles (m, 3, 3) viewed horizontally, each transmitting (1 − coverage)."""
    height = float(np.ptp(triangles_m[:, :, 1]))
    pixel = height / PIXELS_HIGH
    areas: list[float] = []
    for angle in (
        np.arange(DIRECTION_COUNT) * np.pi / DIRECTION_COUNT
    ):  # opposite directions have the same silhouette
        sideways = triangles_m[:, :, 0] * np.cos(angle) + triangles_m[:, :, 2] * np.sin(angle)
        flat = (
            np.stack([sideways - sideways.min(), triangles_m[:, :, 1] - triangles_m[:, :, 1].min()], axis=2)
            / pixel
        )
        clear = np.ones((PIXELS_HIGH + 1, int(flat[:, :, 0].max()) + 2))
        _draw(np.ascontiguousarray(flat), 1.0 - coverage, clear)
        areas.append(float((1.0 - clear).sum()) * pixel**2)
    return float(np.mean(areas))
