"""Draws triangles into a picture of what the eye sees first, as parallel rays meet it."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np
import numpy.typing as npt

from galewood.util import Floats

Single = npt.NDArray[np.float32]
NOTHING_M = -1e30
"""Depth where no ray meets anything."""


@dataclass(frozen=True)
class Seen:
    """What the rays through the middles of the pixels meet; row 0 is the top."""

    depth_m: Floats
    """(n, n) along the axis towards the eye; NOTHING_M: nothing."""
    look: Single
    """(n, n, 6) base colour, linear, and normal in the axes of the tree."""

    @staticmethod
    def nothing(side: int) -> Seen:
        """An empty picture."""
        return Seen(np.full((side, side), NOTHING_M), np.zeros((side, side, 6), np.float32))


@numba.njit(cache=True, nogil=True)
def draw(at, normal, uv, picture, cutoff, depth_m, look):  # type: ignore[no-untyped-def]
    """Draw triangles, in place.

    Args:
        at: (f, 3, 3) corners: column and row, px (the middle of the first pixel is 0.5), and depth, m.
        normal: (f, 3, 3) normals of the corners.
        uv: (f, 3, 2) texture coordinates; the picture repeats.
        picture: (h, w, 4) base colour, linear, and opacity: the texel at a place counts.
        cutoff: Places with less opacity are holes.
        depth_m, look: of Seen.
    """
    rows, columns = depth_m.shape
    high, wide = picture.shape[0], picture.shape[1]
    for f in range(len(at)):
        t = at[f]
        area = (t[1, 0] - t[0, 0]) * (t[2, 1] - t[0, 1]) - (t[2, 0] - t[0, 0]) * (t[1, 1] - t[0, 1])
        if area == 0.0:
            continue
        left, right = min(t[0, 0], t[1, 0], t[2, 0]), max(t[0, 0], t[1, 0], t[2, 0])
        top, bottom = min(t[0, 1], t[1, 1], t[2, 1]), max(t[0, 1], t[1, 1], t[2, 1])
        for j in range(max(0, int(np.ceil(top - 0.5))), min(rows - 1, int(np.floor(bottom - 0.5))) + 1):
            for i in range(
                max(0, int(np.ceil(left - 0.5))), min(columns - 1, int(np.floor(right - 0.5))) + 1
            ):
                x, y = i + 0.5, j + 0.5
                a = ((t[1, 0] - x) * (t[2, 1] - y) - (t[2, 0] - x) * (t[1, 1] - y)) / area
                b = ((t[2, 0] - x) * (t[0, 1] - y) - (t[0, 0] - x) * (t[2, 1] - y)) / area
                c = 1.0 - a - b
                if a < 0.0 or b < 0.0 or c < 0.0:
                    continue
                deep = a * t[0, 2] + b * t[1, 2] + c * t[2, 2]
                if deep <= depth_m[j, i]:
                    continue
                u = a * uv[f, 0, 0] + b * uv[f, 1, 0] + c * uv[f, 2, 0]
                v = a * uv[f, 0, 1] + b * uv[f, 1, 1] + c * uv[f, 2, 1]
                texel = picture[int(np.floor(v * high)) % high, int(np.floor(u * wide)) % wide]
                if texel[3] < cutoff:
                    continue
                depth_m[j, i] = deep
                for k in range(3):
                    look[j, i, k] = texel[k]
                    look[j, i, 3 + k] = a * normal[f, 0, k] + b * normal[f, 1, k] + c * normal[f, 2, k]
