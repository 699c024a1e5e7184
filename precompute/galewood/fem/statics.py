"""Static rest pose of a tree under its own weight."""

from typing import Any, NamedTuple

import numpy as np

from galewood.fem.assembly import ElementSystem
from galewood.util import Floats

LARGEST_SAG = 0.1
"""Sag over height above which the given shape is taken as already bent by the weight."""


class SagsTooFar(ArithmeticError):
    """The static equilibrium is farther from the given shape than a real tree's would be."""


class RestPose(NamedTuple):
    """Displacement (N,3) m of the rest pose, gravity (N,3) N to apply in the simulation, and a report."""

    u_m: Floats
    gravity_n: Floats
    report: dict[str, Any]


def gravity_rest_pose(system: ElementSystem, gravity_n: Floats, height_m: float) -> RestPose:
    """Static equilibrium under gravity by Newton's method; nodes in mesh order.

    Raises SagsTooFar if the tree would collapse, or hang far from its given shape.
    """
    u, iterations, converged = solve_static(system, gravity_n)
    sag = float(np.abs(u).max()) / height_m if np.isfinite(u).all() else float("inf")
    if converged and sag <= LARGEST_SAG:
        return RestPose(u, gravity_n, {"kind": "sagged", "sag_fraction": sag, "iterations": iterations})
    raise SagsTooFar


def loaded_pose(system: ElementSystem, gravity_n: Floats) -> Floats:
    """Small displacement (N,3), m, whose strain balances gravity in the given shape; nodes in mesh order.

    For a shape that has grown, or was scanned, under its own weight. One linear solution: the strain is small
    even where the displacement is not.
    """
    load = gravity_n[system.order]
    load[system.free :] = 0
    zero = np.zeros_like(load)
    system.assemble(zero, zero, 1.0, np.zeros(len(load)), zero.copy())
    system.solver.factorise(system.values)
    system.solver.solve(load)
    return _in_mesh_order(system, load)


def weightless_pose(gravity_n: Floats) -> RestPose:
    """The given shape as the rest pose without any weight, for a tree that would buckle under it."""
    warning = (
        "This tree would buckle under its own weight, so the weight is left out. The tree sways slightly too "
        "fast; thicker wood or a smaller height would let it stand."
    )
    return RestPose(
        np.zeros_like(gravity_n), np.zeros_like(gravity_n), {"kind": "weightless", "warning": warning}
    )


def solve_static(
    system: ElementSystem, load_n: Floats, *, iterations: int = 60, tolerance: float = 1e-9
) -> tuple[Floats, int, bool]:
    """Displacement (N,3) under dead loads, number of Newton steps, and whether they converged.

    The tangent omits the derivative of the rotations, that is, the moment of the load caused by the sway
    (P–Δ). For a slender tree, the steps therefore shrink slowly, by the ratio of the load to the buckling
    load; this ratio is estimated from two steps and the series extrapolated (Aitken). Convergence is judged
    by the steps, not by the residual, because the first step of a bending deformation stretches all elements.
    """
    load = load_n[system.order]
    load[system.free :] = 0
    u, force, zero = np.zeros_like(load), np.zeros_like(load), np.zeros_like(load)
    no_mass, before = np.zeros(len(load)), np.zeros_like(load)
    farthest = 0.2 * float(np.ptp(system.rest))
    for iteration in range(iterations):
        system.assemble(u, zero, 1.0, no_mass, force)
        step = load - force
        step[system.free :] = 0
        system.solver.factorise(system.values)
        system.solver.solve(step)
        length = float(np.abs(step).max())
        if not np.isfinite(length):
            return _in_mesh_order(system, u), iteration, False
        u += step * min(_aitken_factor(step, before, iteration), farthest / max(length, 1e-300))
        before = step
        if length <= tolerance * float(np.abs(u).max()):
            return _in_mesh_order(system, u), iteration + 1, True
    return _in_mesh_order(system, u), iterations, False


def _aitken_factor(step: Floats, before: Floats, iteration: int) -> float:
    """Sum of the geometric series estimated from two consecutive steps; applied every third step."""
    if iteration % 3 or not iteration:
        return 1.0
    ratio = float(np.vdot(step, before)) / max(float(np.vdot(before, before)), 1e-300)
    return 1 / (1 - ratio) if 0.1 < ratio < 0.95 else 1.0


def _in_mesh_order(system: ElementSystem, u: Floats) -> Floats:
    outer = np.empty_like(u)
    outer[system.order] = u
    return outer
