"""Reduced coordinates of the sampled motion by mass-weighted proper orthogonal decomposition (POD).

The motion is low-rank: u = Σ_k basis_k q_k relative to gravity rest, with few coordinates q.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy.linalg

from galewood.util import Array, Floats

MAX_SNAPSHOTS = 600
"""Largest number of snapshots that determine the basis and its error."""


@dataclass(frozen=True)
class Subspace:
    """A basis scaled so that the farthest vertex of each mode moves 1 m per unit: q is in metres."""

    basis: Floats  # (n, 3, r) m per unit of q
    dual: Floats  # (r, 3n): q = dual @ u.ravel(), the mass-weighted projection
    scale: Floats  # (r,) displacement of the farthest vertex in each mode before scaling
    max_error_m: float  # largest vertex error of the truncation over the snapshots, m
    energy_left: float  # share of the mass-weighted variance outside the basis

    @property
    def modes(self) -> int:
        """r: modes of the basis."""
        return self.basis.shape[2]

    def project(self, displacement_m: Array) -> Floats:
        """(T, r) coordinates q of displacements (T, n, 3), both in m."""
        return displacement_m.reshape(len(displacement_m), -1) @ self.dual.T

    def expand(self, q: Array) -> Floats:
        """(T, n, 3) displacements of coordinates q (T, r), both in m."""
        return np.einsum("nik,tk->tni", self.basis, q)


def thinned(displacements: Iterable[Array], total: int | None = None) -> Floats:
    """(s, 3n) about MAX_SNAPSHOTS snapshots at most, evenly spaced, float64.

    If the ``total`` number of frames is given, only one run (T, n, 3) is in memory at a time.
    """
    if total is None:
        displacements = list(displacements)
        total = sum(len(u) for u in displacements)
    stride = max(1, -(-total // MAX_SNAPSHOTS))
    return np.concatenate([u[::stride].reshape(-1, u.shape[1] * 3).astype(np.float64) for u in displacements])


def fit_subspace(
    snapshots: Floats, mass_kg: Floats, count: int, *, leading: Floats | None = None
) -> Subspace:
    """The ``count`` POD modes of snapshots (s, 3n), fewer if their motion has fewer dimensions.

    ``leading`` (d, 3n) are given shapes that come first.
    Method of snapshots (Sirovich 1987). The Gram matrix and all that follows use float64: in
    float32 modes beyond about twenty would be noise.
    """
    root_mass = np.sqrt(np.repeat(np.maximum(mass_kg, 1e-9 * mass_kg.max()), 3))
    given = np.empty((0, snapshots.shape[1])) if leading is None else leading
    rest = _without(snapshots * root_mass, (given * root_mass).T)
    variance, vectors = scipy.linalg.eigh(rest @ rest.T)
    variance, vectors = variance[::-1], vectors[:, ::-1]
    whole = float(np.square(snapshots * root_mass).sum())
    count = min(count, int(np.sum(variance > 1e-13 * whole)))
    modes, _ = np.linalg.qr(rest.T @ vectors[:, :count])
    modes = _first_positive(modes)
    error_m = _largest((rest - (rest @ modes) @ modes.T) / root_mass)
    left = float(np.maximum(variance[count:], 0).sum()) / whole
    return _scaled(np.concatenate([given, modes.T / root_mass]), root_mass, error_m, left)


def spanned_by(shapes: Floats, mass_kg: Floats) -> Subspace:
    """The subspace of given shapes (d, 3n) alone; its error is not known (NaN)."""
    root_mass = np.sqrt(np.repeat(np.maximum(mass_kg, 1e-9 * mass_kg.max()), 3))
    return _scaled(shapes, root_mass, np.nan, np.nan)


def _without(weighted: Floats, given: Floats) -> Floats:
    """Rows (s, 3n) minus their projection on the span of the columns (3n, d)."""
    if not given.shape[1]:
        return weighted
    span, _ = np.linalg.qr(given)
    return weighted - (weighted @ span) @ span.T


def _first_positive(modes: Floats) -> Floats:
    """Make the largest entry of each mode positive, so that the sign is deterministic."""
    largest = np.argmax(np.abs(modes), axis=0)
    return modes * np.sign(modes[largest, np.arange(modes.shape[1])])


def _largest(residual: Floats) -> float:
    points = residual.reshape(len(residual), -1, 3)
    return float(np.sqrt(np.einsum("sni,sni->sn", points, points).max()))


def _scaled(shapes: Floats, root_mass: Floats, max_error_m: float, energy_left: float) -> Subspace:
    """Scale shapes (r, 3n) so that the farthest vertex moves 1 m, and compute their dual basis."""
    points = shapes.reshape(len(shapes), -1, 3)
    scale = np.sqrt(np.square(points).sum(axis=2).max(axis=1))
    modes = shapes / scale[:, None]
    weighted = modes * root_mass
    dual = np.linalg.solve(weighted @ weighted.T, weighted * root_mass)
    basis = np.ascontiguousarray((points / scale[:, None, None]).transpose(1, 2, 0))
    return Subspace(basis, np.ascontiguousarray(dual), scale, max_error_m, energy_left)


@dataclass(frozen=True)
class QuantisedMotion:
    """Coordinates as integers times scale: prefix sums of dq in a trajectory give the exact pose."""

    scale: npt.NDArray[np.float32]  # (r,)
    dq: npt.NDArray[np.int16]  # (z, r)


STEPS_PER_LARGEST = 8191
"""Largest increment in integer steps: a quarter of the int16 range, to leave room for pose easing."""


def quantum(coordinates: Iterable[Floats]) -> np.float32:
    """Unit of the integers that hold the motion, m: for trajectories of coordinates (T + 1, r)."""
    largest = max(float(np.abs(np.diff(track, axis=0)).max()) for track in coordinates)
    return np.float32(largest / STEPS_PER_LARGEST) if largest > 0 else np.float32(1e-6)


def quantise(coordinates: Iterable[Floats], step: np.float32 | None = None) -> QuantisedMotion:
    """Quantise trajectories of coordinates (T + 1, r): the poses are rounded, dq are their differences.

    ``step`` is the unit; None: ``quantum`` of these trajectories. Raises ValueError if the motion does
    not fit in the integers.
    """
    tracks = list(coordinates)
    step = quantum(tracks) if step is None else step
    rounded = [np.rint((track - track[0]) / float(step)).astype(np.int64) for track in tracks]
    dq = np.concatenate([np.diff(track, axis=0) for track in rounded])
    if np.abs(dq).max() > np.iinfo(np.int16).max:
        raise ValueError("the motion is too fast for its unit")
    return QuantisedMotion(np.full(dq.shape[1], step, np.float32), dq.astype(np.int16))
