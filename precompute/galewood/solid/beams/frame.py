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

JOINT_STIFFNESS_FACTOR = 100.0
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
    dofs = (6 * tree.links[:, :, None] + np.arange(6)).reshape(-1, 12)
    along = tree.points_m[tree.links[:, 1]] - tree.points_m[tree.links[:, 0]]
    turn = np.zeros((len(dofs), 12, 12))
    axes = _axes(along)
    for k in range(0, 12, 3):
        turn[:, k : k + 3, k : k + 3] = axes
    _, mass = beam_matrices(tree.radius_m, tree.length_m, wood)
    stiffness, _ = beam_matrices(np.maximum(tree.radius_m, tree.stiff_radius_m), tree.length_m, wood)
    stiffness *= np.where(tree.hidden, JOINT_STIFFNESS_FACTOR, 1.0)[:, None, None]
    mass *= np.where(tree.hidden, 0.0, 1.0)[:, None, None]
    size = 6 * len(tree.points_m)
    where = (np.repeat(dofs, 12), np.tile(dofs, 12).ravel())

    def whole(values: Floats) -> csc_array:
        turned = turn.transpose(0, 2, 1) @ values @ turn
        return csc_array(coo_array((turned.ravel(), where), shape=(size, size)))

    return whole(stiffness), whole(mass)


def _axes(along: Floats) -> Floats:
    """(k, 3, 3) rows: axis of each beam (k, 3) and two unit vectors across it."""
    x = along / np.linalg.norm(along, axis=1, keepdims=True)
    y = np.cross(x, np.eye(3)[np.argmin(np.abs(x), axis=1)])
    y /= np.linalg.norm(y, axis=1, keepdims=True)
    return np.stack([x, y, np.cross(x, y)], axis=1)


def beam_matrices(radius_m: Floats, length_m: Floats, wood: Wood) -> tuple[Floats, Floats]:
    """Stiffness and consistent mass (k, 12, 12) of round beams (k,), each along its own first axis.

    Source: Przemieniecki 1968, "Theory of Matrix Structural Analysis", chapters 5 and 11, without shear and
    without rotary inertia in bending.
    """
    radius, length = radius_m[:, None, None], length_m[:, None, None]
    area = np.pi * radius**2
    moment = np.pi * radius**4 / 4
    k, m = np.zeros((2, len(radius_m), 12, 12))
    weight = wood.density_kg_m3 * area * length
    stretch, twist = np.array([0, 6]), np.array([3, 9])
    rod, rod_mass = np.array([[1, -1], [-1, 1]]), np.array([[2, 1], [1, 2]]) / 6
    k[:, stretch[:, None], stretch] = wood.young_longitudinal_pa * area / length * rod
    m[:, stretch[:, None], stretch] = weight * rod_mass
    k[:, twist[:, None], twist] = wood.shear_longitudinal_pa * 2 * moment / length * rod
    m[:, twist[:, None], twist] = weight * radius**2 / 2 * rod_mass
    bend, inertia = _bending(length_m)
    for dofs, sign in ((np.array([1, 5, 7, 11]), 1.0), (np.array([2, 4, 8, 10]), -1.0)):
        signs = np.array([1, sign, 1, sign])
        both = np.outer(signs, signs)
        k[:, dofs[:, None], dofs] = wood.young_longitudinal_pa * moment / length**3 * both * bend
        m[:, dofs[:, None], dofs] = weight / 420 * both * inertia
    return k, m


def _bending(length_m: Floats) -> tuple[Floats, Floats]:
    """(k, 4, 4) bending stiffness over E I / L³, and consistent mass over m / 420."""
    s, one = length_m, np.ones_like(length_m)
    stiffness = [
        [12 * one, 6 * s, -12 * one, 6 * s],
        [6 * s, 4 * s * s, -6 * s, 2 * s * s],
        [-12 * one, -6 * s, 12 * one, -6 * s],
        [6 * s, 2 * s * s, -6 * s, 4 * s * s],
    ]
    mass = [
        [156 * one, 22 * s, 54 * one, -13 * s],
        [22 * s, 4 * s * s, 13 * s, -3 * s * s],
        [54 * one, 13 * s, 156 * one, -22 * s],
        [-13 * s, -3 * s * s, -22 * s, 4 * s * s],
    ]
    return np.array(stiffness).transpose(2, 0, 1), np.array(mass).transpose(2, 0, 1)
