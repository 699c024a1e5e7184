"""Small motion of a chain of rigid bodies about its rest pose: mass, stiffness, response, natural modes.

Coordinates: the angles of the hinges, three to a body (bending twice, torsion), in the order of the bodies.
Hinge j moves a point at x that its body carries by a_j × (x − x_j) per radian.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from galewood.io.export.rigid.bodies import GROUND_BODY, RigidTree
from galewood.solid.model import GRAVITY_M_S2
from galewood.util import Floats, Ints


@dataclass(frozen=True)
class Masses:
    """Mass (b,), kg, centre (b, 3), m, and inertia about it (b, 3, 3), kg m², of bodies."""

    mass_kg: Floats
    centre_m: Floats
    inertia: Floats


@dataclass(frozen=True)
class ChainModes:
    """Lowest natural modes."""

    frequency_hz: Floats
    """(k,) ascending."""
    angle: Floats
    """(3b, k) rad, mass-normalised."""

    def slope(self, stiffness: Floats) -> Floats:
        """(k, 3b) derivative of ln ω² of each mode by the logarithm of each hinge's stiffness (3b,)."""
        return stiffness * np.square(self.angle.T) / np.square(2 * np.pi * self.frequency_hz)[:, None]


def jacobian(tree: RigidTree, body: Ints, point_m: Floats) -> Floats:
    """(p, 3, 3b) displacement of points (p, 3) on bodies (p,) per radian of each hinge."""
    axis = tree.axes.reshape(-1, 3)
    carried = np.repeat(_carried(tree, body), 3, axis=1)
    arm = point_m[:, None] - np.repeat(tree.hinge_m, 3, axis=0)[None]
    return (np.cross(axis[None], arm) * carried[:, :, None]).transpose(0, 2, 1)


def turns(tree: RigidTree, body: Ints) -> Floats:
    """(p, 3, 3b) rotation of bodies (p,) per radian of each hinge."""
    carried = np.repeat(_carried(tree, body), 3, axis=1)
    return (tree.axes.reshape(-1, 3)[None] * carried[:, :, None]).transpose(0, 2, 1)


def _carried(tree: RigidTree, body: Ints) -> Floats:
    return np.where((body == GROUND_BODY)[:, None], 0.0, tree.below()[body])


def mass_matrix(tree: RigidTree, masses: Masses) -> Floats:
    """(3b, 3b) kg m²."""
    every = np.arange(tree.count)
    moves = jacobian(tree, every, masses.centre_m) * np.sqrt(masses.mass_kg)[:, None, None]
    turned = turns(tree, every)
    rows = moves.reshape(-1, moves.shape[2])
    spun = (masses.inertia @ turned).reshape(-1, moves.shape[2])
    return rows.T @ rows + turned.reshape(-1, moves.shape[2]).T @ spun


def gravity(tree: RigidTree, masses: Masses) -> tuple[Floats, Floats]:
    """Torque of the weight on each hinge (3b,), N m, and its stiffness (3b, 3b), N m/rad: upright, negative.

    The weight's potential is Σ m g y. MuJoCo turns a body about its hinges one after another, so the second
    derivative by the angles i and j, i before j from the ground on, is m g y·(a_i × (a_j × (c − x_j))).
    """
    below = tree.below()
    weight = GRAVITY_M_S2 * masses.mass_kg
    moment = below.T @ (weight[:, None] * masses.centre_m) - (below.T @ weight)[:, None] * tree.hinge_m
    axis = tree.axes.reshape(-1, 3)
    swung = np.cross(axis, np.repeat(moment, 3, axis=0))
    pair = np.cross(axis[:, None], swung[None])[:, :, 1]
    carried = np.kron(below.T, np.ones((3, 3)))
    upper = np.triu(np.ones_like(pair)) * carried * pair
    return -swung[:, 1], upper + np.triu(upper, 1).T


def natural_modes(mass: Floats, stiffness: Floats, count: int) -> ChainModes:
    """The lowest modes of a mass and a positive definite stiffness matrix (3b, 3b)."""
    size = len(stiffness)
    lowest = [max(size - count, 0), size - 1]
    value, vector = scipy.linalg.eigh(mass, stiffness, subset_by_index=lowest)  # of 1/ω²
    omega = 1.0 / np.sqrt(value[::-1])
    return ChainModes(omega / (2 * np.pi), vector[:, ::-1] * omega)
