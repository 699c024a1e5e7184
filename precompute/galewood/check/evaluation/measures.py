"""Error figures of an evaluation: distances between a motion of vertices and the reference solution.

Lengths are over the tree's height unless their name ends in a unit; ``sway`` is the largest displacement of
any vertex of the reference solution from rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial import KDTree

from galewood.util import Array, Floats

FRAMES_SHOWN = (20, 22, 40, 60)
"""Frames of the paper's Fig. 3, counted from 1."""
CHUNK_FRAMES = 64
MIN_SWAY_SHARE = 1e-3
"""Growth relative to the sway is undefined if a half sways by less than this share of the height."""


@dataclass(frozen=True)
class ErrorByFrame:
    """Per frame (T,): largest error, mean squared error, and largest displacement of the reference."""

    largest_m: Floats
    mean_square_m2: Floats
    sway_m: Floats


def errors(track: Array, reference: Array, weight: Array | None = None) -> ErrorByFrame:
    """Errors between two motions (T, n, 3), m; ``weight`` (n,) is how many vertices each one represents."""
    gap = np.sqrt(np.square(track.astype(np.float64) - reference).sum(axis=2))
    sway = np.sqrt(np.square(reference, dtype=np.float64).sum(axis=2).max(axis=1))
    return ErrorByFrame(gap.max(axis=1), np.average(gap**2, axis=1, weights=weight), sway)


def joined(parts: list[ErrorByFrame]) -> ErrorByFrame:
    """Concatenate the pieces of a run."""
    names = ErrorByFrame.__dataclass_fields__
    return ErrorByFrame(**{name: np.concatenate([getattr(part, name) for part in parts]) for name in names})


def after(error: ErrorByFrame, lead: int) -> ErrorByFrame:
    """Drop the first ``lead`` frames of a run."""
    names = ErrorByFrame.__dataclass_fields__
    return ErrorByFrame(**{name: getattr(error, name)[lead:] for name in names})


def figures(error: ErrorByFrame, height_m: float, lead: int = 0) -> dict[str, Any]:
    """Figures of one motion of one set of vertices; growth is measured after ``lead`` frames."""
    largest, sway = error.largest_m, max(float(error.sway_m.max()), 1e-12)
    rms = float(np.sqrt(error.mean_square_m2.mean()))
    shown = [frame for frame in FRAMES_SHOWN if frame <= len(largest)]
    return {
        "max_error": float(largest.max() / height_m),
        "rms_error": rms / height_m,
        "max_error_of_sway": float(largest.max() / sway),
        "rms_error_of_sway": rms / sway,
        "late_error": float(largest[-max(1, len(largest) // 6) :].max() / height_m),
        "last_error": float(largest[-1] / height_m),
        **growth(after(error, lead), height_m),
        "frames": {str(frame): float(largest[frame - 1] / height_m) for frame in shown},
        "error_by_frame": [float(value) for value in largest / height_m],
    }


def growth(error: ErrorByFrame, height_m: float) -> dict[str, float | None]:
    """Largest error of the second half over that of the first, plain and relative to each half's sway.

    None where the first half has no error, or where a half barely moves (``MIN_SWAY_SHARE``).
    """
    half = len(error.largest_m) // 2
    first, second = error.largest_m[:half].max(), error.largest_m[half:].max()
    sway = error.sway_m[:half].max(), error.sway_m[half:].max()
    if first <= 0.0:
        return {"growth": None, "growth_of_sway": None}
    moves = min(sway) > MIN_SWAY_SHARE * height_m
    relative = float(second / sway[1] / (first / sway[0])) if moves else None
    return {"growth": float(second / first), "growth_of_sway": relative}


def hausdorff(a: Floats, b: Floats) -> float:
    """Symmetric Hausdorff distance of two point sets (n, 3) and (m, 3), m."""
    return float(max(KDTree(a).query(b)[0].max(), KDTree(b).query(a)[0].max()))


def hausdorff_by_frame(rest_m: Floats, track: Array, reference: Array, height_m: float) -> dict[str, float]:
    """Hausdorff distance over the height of the displaced vertices, at the frames of the paper."""
    shown = [frame for frame in FRAMES_SHOWN if frame <= len(track)]
    return {
        str(frame): hausdorff(rest_m + track[frame - 1], rest_m + reference[frame - 1]) / height_m
        for frame in shown
    }


def windows(error: ErrorByFrame, frames: int, height_m: float) -> list[dict[str, float]]:
    """Errors and sway of every complete window of ``frames`` frames."""
    whole = len(error.largest_m) // frames
    split = (slice(k * frames, (k + 1) * frames) for k in range(whole))
    return [
        {
            "max_error": float(error.largest_m[part].max() / height_m),
            "rms_error": float(np.sqrt(error.mean_square_m2[part].mean()) / height_m),
            "sway": float(error.sway_m[part].max() / height_m),
        }
        for part in split
    ]
