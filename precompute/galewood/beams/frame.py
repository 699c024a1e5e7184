"""A tree as a space frame of round Euler–Bernoulli beams.

It needs no tetrahedra, so it moves a tree before its wood is meshed. It shares only the material constants
with the finite elements, so it also verifies them, on skeletons with exact radii.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array

from galewood.util import Floats, Int64s
from galewood.wood import Wood

STIFF = 100.0
"""Stiffness factor of the part of a branch inside its parent limb."""


@dataclass(frozen=True)
class Frame:
    """points_m (n, 3), links (k, 2), radius_m (k,) of each link, hidden (k,): link inside its parent.

    Links are as stiff as if their radius were at least ``stiff_radius_m``: drawn twigs taper to a point, and
    one leaf card stands for many leaves, so that beams as thin as drawn could not carry what hangs on them.
    """

    points_m: Floats
    links: Int64s
    radius_m: Floats
    hidden: NDArray[np.bool_]
    stiff_radius_m: float = 0.0

    @property
    def length_m(self) -> Floats:
        """(k,) length of each link, m."""
        return np.linalg.norm(self.points_m[self.links[:, 1]] - self.points_m[self.links[:, 0]], axis=1)

    def volume_m3(self) -> float:
        """Volume of the wood, m³, without hidden links."""
        return float((np.pi * self.radius_m**2 * self.length_m)[~self.hidden].sum())


@dataclass(frozen=True)
class FrameModes:
    """Lowest natural modes of a frame: frequencies_hz (k,), mass-normalised shapes (k, n, 6), 1/√kg.

    The last axis holds displacement and rotation (rad) of a point.
    """

    frequencies_hz: Floats
    shapes: Floats


def frame_frequencies(
    tree: Frame, wood: Wood, clamped_m: float, count: int, point_mass_kg: Floats | None = None
) -> Floats:
    """(count,) lowest frequencies, Hz; otherwise like ``frame_modes``."""
    return frame_modes(tree, wood, clamped_m, count, point_mass_kg).frequencies_hz


def frame_modes(
    tree: Frame, wood: Wood, clamped_m: float, count: int, point_mass_kg: Floats | None = None
) -> FrameModes:
    """The ``count`` lowest modes, without gravity; points not above `clamped_m` are clamped.

    `point_mass_kg` (n,) is additional mass at the points, such as foliage.
    """
    from scipy.sparse.linalg import eigsh  # slow to load

    stiffness, mass = frame_matrices(tree, wood)
    if point_mass_kg is not None:
        mass = mass + _lumped(point_mass_kg)
    free = np.flatnonzero(np.repeat(tree.points_m[:, 1] > clamped_m, 6))
    stiffness, mass = csc_array(stiffness[free][:, free]), csc_array(mass[free][:, free])
    squares, vectors = eigsh(stiffness, count, M=mass, sigma=0, v0=np.ones(len(free)))
    order = np.argsort(squares)
    shapes = np.zeros((count, 6 * len(tree.points_m)))
    shapes[:, free] = vectors[:, order].T
    return FrameModes(np.sqrt(squares[order]) / (2 * np.pi), shapes.reshape(count, -1, 6))


def _lumped(mass_kg: Floats) -> csc_array:
    size = 6 * len(mass_kg)
    rows = (6 * np.arange(len(mass_kg))[:, None] + np.arange(3)).ravel()
    return csc_array(coo_array((np.repeat(mass_kg, 3), (rows, rows)), shape=(size, size)))


def frame_matrices(tree: Frame, wood: Wood) -> tuple[csc_array, csc_array]:
    """Stiffness and consistent mass (6n, 6n), with three displacements and three rotations per point."""
    rows: list[Int64s] = []
    columns: list[Int64s] = []
    stiff: list[Floats] = []
    heavy: list[Floats] = []
    for (a, b), radius, length, hidden in zip(
        tree.links, tree.radius_m, tree.length_m, tree.hidden, strict=True
    ):
        turn = np.kron(np.eye(4), _axes(tree.points_m[b] - tree.points_m[a]))
        dofs = np.concatenate([6 * a + np.arange(6), 6 * b + np.arange(6)])
        rows.append(np.repeat(dofs, 12))
        columns.append(np.tile(dofs, 12))
        k, m = beam_matrices(radius, length, wood)
        if radius < tree.stiff_radius_m:
            k, _ = beam_matrices(tree.stiff_radius_m, length, wood)
        stiff.append((turn.T @ k @ turn * (STIFF if hidden else 1.0)).ravel())
        heavy.append((turn.T @ m @ turn * (0.0 if hidden else 1.0)).ravel())
    size = 6 * len(tree.points_m)
    where = (np.concatenate(rows), np.concatenate(columns))

    def whole(values: list[Floats]) -> csc_array:
        return csc_array(coo_array((np.concatenate(values), where), shape=(size, size)))

    return whole(stiff), whole(heavy)


def _axes(along: Floats) -> Floats:
    """(3, 3) rows: axis of the beam and two unit vectors across it."""
    x = along / float(np.linalg.norm(along))
    y = np.cross(x, np.eye(3)[int(np.argmin(np.abs(x)))])
    y = y / float(np.linalg.norm(y))
    return np.array([x, y, np.cross(x, y)], dtype=np.float64)


def beam_matrices(radius_m: float, length_m: float, wood: Wood) -> tuple[Floats, Floats]:
    """Stiffness and consistent mass (12, 12) of a round beam along its first axis.

    Source: Przemieniecki 1968, "Theory of Matrix Structural Analysis", chapters 5 and 11, without shear and
    without rotary inertia in bending.
    """
    area = np.pi * radius_m**2
    moment = np.pi * radius_m**4 / 4
    k, m = np.zeros((12, 12)), np.zeros((12, 12))
    weight = wood.density_kg_m3 * area * length_m
    stretch, twist = [0, 6], [3, 9]
    rod, rod_mass = np.array([[1, -1], [-1, 1]]), np.array([[2, 1], [1, 2]]) / 6
    k[np.ix_(stretch, stretch)] = wood.young_longitudinal_pa * area / length_m * rod
    m[np.ix_(stretch, stretch)] = weight * rod_mass
    k[np.ix_(twist, twist)] = wood.shear_longitudinal_pa * 2 * moment / length_m * rod
    m[np.ix_(twist, twist)] = weight * radius_m**2 / 2 * rod_mass
    bend, inertia = _bending(length_m)
    for dofs, sign in (([1, 5, 7, 11], 1.0), ([2, 4, 8, 10], -1.0)):
        signs = np.array([1, sign, 1, sign])
        both = np.outer(signs, signs)
        k[np.ix_(dofs, dofs)] = wood.young_longitudinal_pa * moment / length_m**3 * both * bend
        m[np.ix_(dofs, dofs)] = weight / 420 * both * inertia
    return k, m


def _bending(length_m: float) -> tuple[Floats, Floats]:
    """(4, 4) bending stiffness over E I / L³, and consistent mass over m / 420."""
    s = length_m
    stiffness = [
        [12, 6 * s, -12, 6 * s],
        [6 * s, 4 * s * s, -6 * s, 2 * s * s],
        [-12, -6 * s, 12, -6 * s],
        [6 * s, 2 * s * s, -6 * s, 4 * s * s],
    ]
    mass = [
        [156, 22 * s, 54, -13 * s],
        [22 * s, 4 * s * s, 13 * s, -3 * s * s],
        [54, 13 * s, 156, -22 * s],
        [-13 * s, -3 * s * s, -22 * s, 4 * s * s],
    ]
    return np.array(stiffness, float), np.array(mass, float)
