"""Equilibrium of a tree of beams under dead loads, for displacements and rotations of any size.

A tree of beams clamped at its root is a set of rods without loops: the force in each rod is the sum of the
loads outboard of it, whatever the pose. What remains are the balances of moments at the points. A rod between
two points with the rotations R_a and R_b has the curvature ψ / L, ψ = log(R_aᵀ R_b), constant along it, and
points along R_m t, R_m = R_a exp(ψ / 2). Its moment is R_m (C ψ / L + m₀): C holds E I across and G J along
the axis, m₀ is the moment with which it bears the weight in the given shape. Rods do not stretch or shear.
Newton's method on the rotations needs one elimination from the tips to the root per step: the matrix of a
tree has no fill.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from galewood.solid.beams.bending_kernels import (
    carried_loads,
    moments_about,
    moments_and_places,
    moved_by,
    newton,
    rest_moments,
    solved,
    tangent,
)
from galewood.util import Floats, Int64s

SMALLEST_PART = 1 / 256
"""Smallest part of a load that is added at once."""
EIGENVALUE_TOLERANCE: Any = 1e-6  # scipy's type annotation requires an int


_Blocks = tuple[Floats, Floats, Floats]
"""Of ``tangent``: of each point, and of each rod by the rotation of its inner and of its outer end."""


class NoEquilibrium(ArithmeticError):
    """No equilibrium was found under a load."""


@dataclass(frozen=True)
class Rods:
    """A tree of rods: each point i but the first is the outer end of rod i, whose inner end is parent[i] < i.

    along_m (n, 3) from the inner to the outer end, bending_n_m2 (n,) E I, twisting_n_m2 (n,) G J; clamped
    (n,) is 1 for points that neither move nor turn. weight_n (n,) hangs at the points in the given shape,
    which is at rest.
    """

    parent: Int64s
    along_m: Floats
    bending_n_m2: Floats
    twisting_n_m2: Floats
    clamped: Int64s
    weight_n: Floats

    @property
    def shape(self) -> tuple[Int64s, Floats, Floats, Floats]:
        """What the kernels take."""
        return self.parent, self.along_m, self.bending_n_m2, self.twisting_n_m2

    @property
    def length_m(self) -> Floats:
        """(n,) length of each rod, m; that of the first point is 0."""
        return np.linalg.norm(self.along_m, axis=1)

    @property
    def axis(self) -> Floats:
        """(n, 3) unit vector along each rod; zero for the first point."""
        return self.along_m / np.maximum(self.length_m, 1e-12)[:, None]

    def stiffened(self, factor: Floats) -> Rods:
        """The rods with their stiffness times factors (n,)."""
        return replace(
            self, bending_n_m2=self.bending_n_m2 * factor, twisting_n_m2=self.twisting_n_m2 * factor
        )


@dataclass(frozen=True)
class BentRods:
    """Pose of rods under a load: turns (n, 3, 3) and displacement_m (n, 3) of the points.

    moment_nm (n, 3) are the moments in the middle of each rod by the load and by the weight in the bent pose,
    without those with which the rods bear the weight in the given shape; in axes that turn with the rods.
    """

    turns: Floats
    moment_nm: Floats
    displacement_m: Floats


def bent(rods: Rods, load_n: Floats, start: BentRods | None = None) -> BentRods:
    """The rods under forces (n, 3), N, that keep their direction, besides their weight.

    A solution of a similar load as the start saves time. The load is added in halves, quarters and so on
    where Newton's method does not converge at once. Raises NoEquilibrium if it does not even in small parts.
    """
    weight = _weight(rods)
    held = rest_moments(rods.parent, rods.along_m, carried_loads(rods.parent, weight))

    def balanced(turns: Floats, share: float) -> bool:
        carried = carried_loads(rods.parent, weight + share * load_n)
        return bool(newton(rods.shape, rods.clamped, held, carried, turns))

    if start is not None and balanced(turns := start.turns.copy(), 1.0):
        return _pose(rods, turns)
    turns, done, part = np.tile(np.eye(3), (len(load_n), 1, 1)), 0.0, 1.0
    while done < 1:
        target, tried = min(done + part, 1.0), turns.copy()
        if balanced(tried, target):
            turns, done = tried, target
        elif part <= SMALLEST_PART:
            raise NoEquilibrium(f"no equilibrium was found beyond {done:.0%} of the load")
        else:
            part /= 2
    return _pose(rods, turns)


def _weight(rods: Rods) -> Floats:
    weight = np.zeros_like(rods.along_m)
    weight[:, 1] = -rods.weight_n
    return weight


def _pose(rods: Rods, turns: Floats) -> BentRods:
    return BentRods(turns, *moments_and_places(rods.shape, turns))


@dataclass(frozen=True)
class RodBuckling:
    """Ways to give way under the weight: load factors (k,), falling, and energy_j (k, n) of the rods."""

    load_factor: Floats
    energy_j: Floats


def rod_buckling(rods: Rods, count: int) -> RodBuckling:
    """The ``count`` largest load factors (weight over buckling load) of rods in their given shape."""
    n, none = len(rods.parent), np.zeros_like(rods.along_m)
    still = np.tile(np.eye(3), (n, 1, 1))
    carried = carried_loads(rods.parent, _weight(rods))
    elastic: _Blocks = tangent(rods.shape, none, none, still)[:3]
    whole: _Blocks = tangent(rods.shape, rest_moments(rods.parent, rods.along_m, carried), carried, still)[:3]
    values, turned = _largest_over(
        rods, elastic, count, lambda at: _times(rods.parent, elastic, at) - _times(rods.parent, whole, at)
    )
    return RodBuckling(values, _energies(rods, turned))


@dataclass(frozen=True)
class RodModes:
    """Natural modes about a pose: frequencies_hz (k,), rising, and shapes (k, n, 3) of the points, 1/√kg."""

    frequencies_hz: Floats
    shapes: Floats


def rod_modes(rods: Rods, load_n: Floats, pose: BentRods, mass_kg: Floats, count: int) -> RodModes:
    """The ``count`` lowest modes of rods with masses (n,) at their points, about their pose under a load.

    The load and the weight keep their directions, and bend the rods further as they move.
    """
    weight = _weight(rods)
    held = rest_moments(rods.parent, rods.along_m, carried_loads(rods.parent, weight))
    blocks: _Blocks = tangent(rods.shape, held, carried_loads(rods.parent, weight + load_n), pose.turns)[:3]
    axis = rods.along_m + pose.displacement_m - pose.displacement_m[np.maximum(rods.parent, 0)]

    def inertia(turned: Floats) -> Floats:
        return moments_about(rods.parent, axis, mass_kg[:, None] * moved_by(rods.parent, axis, turned))

    squares, turned = _largest_over(rods, _symmetric(blocks), count, inertia)
    shapes = np.stack([moved_by(rods.parent, axis, one) for one in turned])
    return RodModes(1 / (2 * np.pi * np.sqrt(squares)), shapes / np.sqrt(squares)[:, None, None])


def _symmetric(blocks: _Blocks) -> _Blocks:
    """The symmetric part: what it lacks vanishes with the length of the rods."""
    diagonal, to_inner, to_outer = blocks
    across = (to_inner + to_outer.transpose(0, 2, 1)) / 2
    return (diagonal + diagonal.transpose(0, 2, 1)) / 2, across, across.transpose(0, 2, 1).copy()


def _largest_over(
    rods: Rods, stiffness: _Blocks, count: int, product: Callable[[Floats], Floats]
) -> tuple[Floats, Floats]:
    """Largest λ (k,), falling, and rotations v (k, n, 3) of a product A v = λ K v; vᵀ K v = 1."""
    from scipy.sparse.linalg import LinearOperator, eigsh  # slow to load

    n, free = len(rods.parent), np.flatnonzero(rods.clamped == 0)
    size = 3 * len(free)

    def operator(product: Callable[[Floats], Floats]) -> Any:
        def on_free(values: Floats) -> Floats:
            at = np.zeros((n, 3))
            at[free] = values.reshape(-1, 3)
            return product(at)[free].ravel()

        return LinearOperator((size, size), matvec=on_free, dtype=np.float64)  # pyright: ignore[reportCallIssue]

    def turned_by(moment_nm: Floats) -> Floats:
        diagonal, to_inner, to_outer = (blocks.copy() for blocks in stiffness)  # they are overwritten
        return solved(rods.parent, rods.clamped, diagonal, to_inner, to_outer, moment_nm)

    values, vectors = eigsh(
        operator(product),
        min(count, size - 1),
        M=operator(lambda at: _times(rods.parent, stiffness, at)),
        Minv=operator(turned_by),
        which="LA",
        tol=EIGENVALUE_TOLERANCE,
        v0=np.random.default_rng(0).normal(size=size),
    )
    falling = np.argsort(-values)
    turned = np.zeros((len(values), n, 3))
    turned[:, free] = vectors[:, falling].T.reshape(len(values), -1, 3)
    return values[falling], turned


def _times(parent: Int64s, blocks: _Blocks, at: Floats) -> Floats:
    """Product of the symmetric part of the blocks of ``tangent`` with small rotations (n, 3)."""
    diagonal, to_inner, to_outer = blocks
    across = (to_inner[1:] + to_outer[1:].transpose(0, 2, 1)) / 2
    found = np.einsum("nij,nj->ni", (diagonal + diagonal.transpose(0, 2, 1)) / 2, at)
    found[1:] += np.einsum("nij,nj->ni", across, at[parent[1:]])
    np.add.at(found, parent[1:], np.einsum("nji,nj->ni", across, at[1:]))
    return found


def _energies(rods: Rods, turned: Floats) -> Floats:
    """(k, n) elastic energy of each rod, J, by small rotations (k, n, 3) of the points."""
    bend = turned - turned[:, np.maximum(rods.parent, 0)]
    twist = np.einsum("kni,ni->kn", bend, rods.axis) ** 2
    across = (bend**2).sum(axis=2) - twist
    energy = rods.bending_n_m2 * across + rods.twisting_n_m2 * twist
    return energy / (2 * np.maximum(rods.length_m, 1e-12))
