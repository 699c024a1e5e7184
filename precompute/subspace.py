"""Reduced coordinates of the sampled motion: mass-weighted proper orthogonal decomposition.

The motion is low-rank: a tree's pose is a handful of numbers q, and
u = Σ_k basis_k q_k relative to gravity rest.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy.linalg

Array = npt.NDArray[Any]
Floats = npt.NDArray[np.float64]

MAX_SNAPSHOTS = 1500
"""Snapshots that shape the basis; every sample is still projected on it and counted in the error."""


@dataclass(frozen=True)
class Subspace:
    """A basis scaled so that a mode's largest vertex moves 1 m per unit: q is in metres."""

    basis: Floats  # (n, 3, r) m per unit of q
    dual: Floats  # (r, 3n): q = dual @ u.ravel(), the mass-weighted projection
    max_error_m: float  # largest vertex error of the truncation over the snapshots
    energy_left: float  # share of the mass-weighted variance outside the basis

    @property
    def modes(self) -> int:
        return self.basis.shape[2]

    def project(self, displacement_m: Array) -> Floats:
        """(T, r) coordinates of displacements (T, n, 3)."""
        return displacement_m.reshape(len(displacement_m), -1) @ self.dual.T

    def expand(self, q: Array) -> Floats:
        """(T, n, 3) displacements of coordinates (T, r)."""
        return np.einsum("nik,tk->tni", self.basis, q)


def thinned(displacements: Sequence[Array]) -> Floats:
    """At most about MAX_SNAPSHOTS evenly chosen snapshots (s, 3n), float64."""
    total = sum(len(u) for u in displacements)
    stride = max(1, -(-total // MAX_SNAPSHOTS))
    return np.concatenate([u[::stride].reshape(-1, u.shape[1] * 3) for u in displacements]).astype(np.float64)


def fit_subspace(
    snapshots: Floats, mass_kg: Floats, tolerance_m: float, *, least: int = 8, most: int = 24
) -> Subspace:
    """The fewest modes (least..most) that reproduce all snapshots (s, 3n) within tolerance_m at every vertex.

    Method of snapshots (Sirovich 1987). The Gram matrix and everything after it stay in float64: in float32
    the modes beyond some twenty would be noise.
    """
    root_mass = np.sqrt(np.repeat(np.maximum(mass_kg, 1e-9 * mass_kg.max()), 3))
    weighted = snapshots * root_mass
    variance, vectors = scipy.linalg.eigh(weighted @ weighted.T)
    variance, vectors = variance[::-1], vectors[:, ::-1]
    most = max(1, min(most, int(np.sum(variance > 1e-12 * variance[0]))))
    modes, _ = np.linalg.qr(weighted.T @ vectors[:, :most])
    modes = _first_positive(modes)
    errors = _max_errors(snapshots, weighted, modes, root_mass)
    enough = [r + 1 for r, error in enumerate(errors) if error <= tolerance_m and r + 1 >= least]
    r = min([*enough, most])
    left = float(np.maximum(variance[r:], 0).sum() / np.maximum(variance, 0).sum())
    return _scaled(modes[:, :r], root_mass, errors[r - 1], left)


def _first_positive(modes: Floats) -> Floats:
    """Fix each mode's sign by its largest entry, so that equal samples give equal bases."""
    largest = np.argmax(np.abs(modes), axis=0)
    return modes * np.sign(modes[largest, np.arange(modes.shape[1])])


def _max_errors(snapshots: Floats, weighted: Floats, modes: Floats, root_mass: Floats) -> list[float]:
    """Largest vertex error over all snapshots with the first 1, 2, … modes."""
    coordinates = weighted @ modes
    residual = snapshots.copy()
    errors: list[float] = []
    for k in range(modes.shape[1]):
        residual -= np.outer(coordinates[:, k], modes[:, k] / root_mass)
        points = residual.reshape(len(residual), -1, 3)
        errors.append(float(np.sqrt(np.einsum("sni,sni->sn", points, points).max())))
    return errors


def _scaled(modes: Floats, root_mass: Floats, max_error_m: float, energy_left: float) -> Subspace:
    shapes = (modes / root_mass[:, None]).reshape(-1, 3, modes.shape[1])
    reach = np.sqrt(np.square(shapes).sum(axis=1).max(axis=0))
    dual = (modes * root_mass[:, None] * reach).T
    return Subspace(
        np.ascontiguousarray(shapes / reach), np.ascontiguousarray(dual), max_error_m, energy_left
    )


@dataclass(frozen=True)
class QuantisedMotion:
    """Coordinates as integers × scale; prefix sums of dq inside a trajectory give the pose without drift."""

    scale: npt.NDArray[np.float32]  # (r,)
    dq: npt.NDArray[np.int16]  # (z, r)


STEPS_PER_LARGEST = 8191
"""The largest recorded increment in integer steps: a quarter of int16, room for what pose easing adds."""


def quantise(coordinates: Iterable[Floats]) -> QuantisedMotion:
    """Integers for each trajectory's coordinates (T + 1, r): poses are rounded, dq are their differences."""
    tracks = list(coordinates)
    largest = max(float(np.abs(np.diff(track, axis=0)).max()) for track in tracks)
    step = np.float32(largest / STEPS_PER_LARGEST) if largest > 0 else np.float32(1e-6)
    rounded = [np.rint((track - track[0]) / float(step)).astype(np.int64) for track in tracks]
    dq = np.concatenate([np.diff(track, axis=0) for track in rounded]).astype(np.int16)
    return QuantisedMotion(np.full(dq.shape[1], step, np.float32), dq)
