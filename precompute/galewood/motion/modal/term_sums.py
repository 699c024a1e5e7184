"""Few sums of terms by which the force of a model can be computed.

The force of an individual acts on its sway alone: all its terms move the oscillators in two ways.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from galewood.constants import MOST_TERM_SUMS, TERM_SUM_ROUNDING
from galewood.util import Array, Floats


@dataclass(frozen=True)
class TermSums:
    """A force (F, d) as the product ``shares.T @ rows``."""

    shares: Floats  # (sums, F)
    rows: Floats  # (sums, d)


def term_sums(force: Array) -> TermSums | None:
    """The sums that give a force (F, d) to rounding; None if it takes more than ``MOST_TERM_SUMS``.

    The largest number that is left determines the next sum (Gaussian elimination with complete pivoting).
    Terms have units of their own, so each row is compared with itself.
    """
    left = np.asarray(force, np.float64)
    most = np.abs(left).max(axis=1, initial=0.0)
    scale = np.where(most > 0.0, most, 1.0)
    left = left / scale[:, None]
    shares, rows = np.zeros((0, len(left))), np.zeros((0, left.shape[1]))
    for _ in range(MOST_TERM_SUMS + 1):
        term, k = np.unravel_index(int(np.abs(left).argmax()), left.shape)
        if abs(left[term, k]) <= TERM_SUM_ROUNDING:
            return TermSums(shares * scale, rows)
        share, row = left[:, k] / left[term, k], left[term].copy()
        shares, rows = np.vstack([shares, share]), np.vstack([rows, row])
        left = left - np.outer(share, row)
    return None
