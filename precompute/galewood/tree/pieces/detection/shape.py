"""Shape of every connected piece, in arrays with one row per piece; all lengths are in the file's unit.

For a long closed tube of diameter D the thickness 4 V / A is D, for an open one and for a ball two thirds of
it, for a sheet 0. The normal tensor Σ a n nᵀ / Σ a has the eigenvalues (1, 0, 0) for a flat card,
(½, ½, 0) for a straight tube and (⅓, ⅓, ⅓) for a ball, whatever the winding.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from galewood.util import Floats, Ints


@dataclass(frozen=True)
class Shapes:
    """Measures of k pieces."""

    faces: Ints  # number of faces
    area: Floats
    thickness: Floats  # 4 V / A
    coherence: Floats  # |Σ a n| / Σ a: 1 for a flat open sheet, 0 for a closed surface
    normals: Floats  # (k, 3) eigenvalues of the normal tensor, in descending order
    along_axes: Floats  # (k, 3) Σ a n_i² / Σ a: the second is 1 for horizontal faces, 0 for vertical ones
    extents: Floats  # (k, 3) along the principal axes, in descending order
    axis: Floats  # (k, 3) unit vector along the longest extent
    centre: Floats  # (k, 3) centroid of the surface
    low: Floats  # (k, 3) corners of the bounding box
    high: Floats
    open_border: Floats  # (length of the border)² / area: 16 for a square card, 0 if closed

    def turned(self, rotation: Floats) -> Shapes:
        """The measures in turned axes; `rotation` (3, 3) maps axes to axes."""
        corners = np.stack([self.low @ rotation.T, self.high @ rotation.T])
        return replace(
            self,
            along_axes=self.along_axes @ np.abs(rotation).T,
            axis=self.axis @ rotation.T,
            centre=self.centre @ rotation.T,
            low=corners.min(axis=0),
            high=corners.max(axis=0),
        )


def measure(corners: Floats, piece: Ints, count: int, border: Floats) -> Shapes:
    """Measures of `count` pieces.

    Args:
        corners: (m, 3, 3) corners of all faces.
        piece: (m,) piece of each face.
        count: Number of pieces; each has at least one face.
        border: (m,) length of the sides of each face that no other face shares.
    """
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    size = np.linalg.norm(normal, axis=1)
    weight = np.maximum(size, 1e-12 * max(float(size.max()), 1e-300))  # degenerate faces keep a position
    area = _sum(piece, weight, count)
    centre = _sum(piece, corners.mean(axis=1) * weight[:, None], count) / area[:, None]
    away = corners - centre[piece][:, None]
    volume = (
        np.abs(_sum(piece, np.einsum("ij,ij->i", away[:, 0], np.cross(away[:, 1], away[:, 2])), count)) / 6
    )
    direction = normal / np.maximum(size, 1e-300)[:, None]
    tensor = _sum(piece, weight[:, None, None] * direction[:, :, None] * direction[:, None, :], count)
    extents, axis = _principal(away, piece, count, weight)
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    np.minimum.at(low, piece, corners.min(axis=1))
    np.maximum.at(high, piece, corners.max(axis=1))
    return Shapes(
        faces=np.bincount(piece, minlength=count).astype(np.int32),
        area=area,
        thickness=4 * volume / area,
        coherence=np.linalg.norm(_sum(piece, normal, count), axis=1) / area,
        normals=np.linalg.eigvalsh(tensor)[:, ::-1] / area[:, None],
        along_axes=np.einsum("kii->ki", tensor) / area[:, None],
        extents=extents,
        axis=axis,
        centre=centre,
        low=low,
        high=high,
        open_border=_sum(piece, border, count) ** 2 / area,
    )


def _sum(piece: Ints, rows: Floats, count: int) -> Floats:
    """Sums of rows (m, ...) over the faces of each piece: (count, ...)."""
    flat = rows.reshape(len(rows), -1)
    sums = np.stack([np.bincount(piece, flat[:, k], count) for k in range(flat.shape[1])], axis=1)
    return np.asarray(sums.reshape(count, *rows.shape[1:]), dtype=np.float64)


def _principal(away: Floats, piece: Ints, count: int, weight: Floats) -> tuple[Floats, Floats]:
    """Extents (k, 3), in descending order, and the longest axis (k, 3)."""
    middle = away.mean(axis=1)
    # second moments of a triangle: (9 m mᵀ + Σ c cᵀ) / 12, m its centroid and c its corners
    second = 9 * middle[:, :, None] * middle[:, None, :] + np.einsum("mki,mkj->mij", away, away)
    _, axes = np.linalg.eigh(_sum(piece, second * weight[:, None, None], count))
    along = np.einsum("mkc,mca->mka", away, axes[piece])
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    np.minimum.at(low, piece, along.min(axis=1))
    np.maximum.at(high, piece, along.max(axis=1))
    span = high - low
    order = np.argsort(-span, axis=1)
    longest = np.take_along_axis(axes, order[:, None, :1], axis=2)[:, :, 0]
    return np.take_along_axis(span, order, axis=1), longest
