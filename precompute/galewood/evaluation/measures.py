"""How far one motion of vertices is from the true one: every figure of an evaluation, by its definition.

All lengths are over the tree's height unless said otherwise; ``sway`` is the farthest that any vertex of
the true motion goes from rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial import KDTree

from galewood.util import Array, Floats

FRAMES_SHOWN = (20, 22, 40, 60)
"""The paper's own frames (its Fig. 3), from 1."""
CHUNK = 64
STILL = 1e-3
"""A half in which the tree sways less than this share of its height has no growth to speak of."""


@dataclass(frozen=True)
class ErrorByFrame:
    """Per frame: the largest error and the mean of its square, and the true motion's largest displacement."""

    largest_m: Floats
    mean_square_m2: Floats
    sway_m: Floats


def errors(track: Array, reference: Array, weight: Array | None = None) -> ErrorByFrame:
    """Of two motions (T, n, 3); ``weight`` (n,) is how many vertices each stands for, in the mean."""
    gap = np.sqrt(np.square(track.astype(np.float64) - reference).sum(axis=2))
    sway = np.sqrt(np.square(reference, dtype=np.float64).sum(axis=2).max(axis=1))
    return ErrorByFrame(gap.max(axis=1), np.average(gap**2, axis=1, weights=weight), sway)


def joined(parts: list[ErrorByFrame]) -> ErrorByFrame:
    """One run from its pieces."""
    names = ErrorByFrame.__dataclass_fields__
    return ErrorByFrame(**{name: np.concatenate([getattr(part, name) for part in parts]) for name in names})


def after(error: ErrorByFrame, lead: int) -> ErrorByFrame:
    """A run without its first frames."""
    names = ErrorByFrame.__dataclass_fields__
    return ErrorByFrame(**{name: getattr(error, name)[lead:] for name in names})


def figures(error: ErrorByFrame, height_m: float, lead: int = 0) -> dict[str, Any]:
    """Figures of one motion of one set of vertices; growth is that after so many frames of lead-in."""
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
    """Largest error of the second half over that of the first; and the same of each half's error over its
    sway.
    """
    half = len(error.largest_m) // 2
    first, second = error.largest_m[:half].max(), error.largest_m[half:].max()
    sway = error.sway_m[:half].max(), error.sway_m[half:].max()
    if first <= 0.0:
        return {"growth": None, "growth_of_sway": None}
    moves = min(sway) > STILL * height_m
    relative = float(second / sway[1] / (first / sway[0])) if moves else None
    return {"growth": float(second / first), "growth_of_sway": relative}


def hausdorff(a: Floats, b: Floats) -> float:
    """The farthest that a point of either set (n, 3) is from the other set, m."""
    return float(max(KDTree(a).query(b)[0].max(), KDTree(b).query(a)[0].max()))


def hausdorff_by_frame(rest_m: Floats, track: Array, reference: Array, height_m: float) -> dict[str, float]:
    """Of the displaced vertices at the paper's frames."""
    shown = [frame for frame in FRAMES_SHOWN if frame <= len(track)]
    return {
        str(frame): hausdorff(rest_m + track[frame - 1], rest_m + reference[frame - 1]) / height_m
        for frame in shown
    }


def windows(error: ErrorByFrame, frames: int, height_m: float) -> list[dict[str, float]]:
    """Error and sway of every full window of so many frames."""
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
