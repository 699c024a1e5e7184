"""Static equilibrium of a tree: strained by its weight in the given shape, and pulled from it."""

import numpy as np

from galewood.solid.fem.elements.assembly import ElementSystem
from galewood.solid.fem.elements.tangent import add_stress_terms, stress_terms
from galewood.solid.fem.solver import NotPositiveDefinite
from galewood.util import Floats

FARTHEST_STEP = 0.5
"""Longest step of Newton's method over the size of the tree."""
SMALLEST_SWAY = 0.5
"""Over the size of the tree. For smaller displacements the tolerance of the steps is not relative, because
those of a tree at rest are rounding alone."""
MOST_PER_STEP, SMALLEST_STEP = 20, 1 / 64
"""Linear solutions before a load step is halved, and the smallest step over the whole load."""


def loaded_pose(system: ElementSystem, gravity_n: Floats) -> Floats:
    """Small displacement (N,3), m, whose strain balances gravity in the given shape; nodes in mesh order.

    A tree has grown, or was drawn or scanned, under its own weight. One linear solution: the strain is small
    even where the displacement is not. Raises NotPositiveDefinite if nothing holds the tree.
    """
    load = gravity_n[system.order]
    load[system.free :] = 0
    zero = np.zeros_like(load)
    system.assemble(zero, zero, 1.0, np.zeros(len(load)), zero.copy())
    system.solver.factorise(system.values)
    system.solver.solve(load)
    return _in_mesh_order(system, load)


def solve_static(
    system: ElementSystem, load_n: Floats, *, iterations: int = 60, tolerance: float = 1e-9
) -> tuple[Floats, int, bool]:
    """Displacement (N,3) under dead loads, number of linear solutions, and whether they converged.

    Newton's method with the rotating part of the tangent (`_newton`). If it fails, the load is applied in
    halves, quarters and so on. The system's prestress is used for the tangent and restored.
    """
    load = load_n[system.order]
    load[system.free :] = 0
    before = system.prestress
    system.set_prestress(np.zeros_like(before))
    try:
        u, used, converged = _in_load_steps(system, load, iterations, tolerance)
    finally:
        system.set_prestress(before)
    return _in_mesh_order(system, u), used, converged


def _in_load_steps(
    system: ElementSystem, load: Floats, iterations: int, tolerance: float
) -> tuple[Floats, int, bool]:
    """The whole load at once or, where that fails, in steps; internal order."""
    u, used, done, part = np.zeros_like(load), 0, 0.0, 1.0
    while done < 1 and used < iterations:
        target = min(done + part, 1.0)
        final = target >= 1
        most = min(iterations - used, MOST_PER_STEP if part > SMALLEST_STEP else iterations)
        found, count, converged = _newton(system, target * load, u, most, tolerance if final else 1e-4)
        used += count
        if converged:
            u, done = found, target
        elif part <= SMALLEST_STEP:
            return found, used, False
        else:
            part /= 2
    return u, used, done >= 1


def _newton(
    system: ElementSystem, load: Floats, start: Floats, iterations: int, tolerance: float
) -> tuple[Floats, int, bool]:
    """Equilibrium near `start` under a load, both in internal order.

    The tangent is that of the corotational elements plus the rotation of their stress (`stress_terms`),
    without which the moment of the load caused by the sway (P–Δ) is missing. The stress is the one that
    balanced the load in the previous linear solution, not the one at the new pose: the nodes move on straight
    lines, so every turning element is first stretched, and its spurious stress would stiffen the tangent
    (mixed-point Newton; Magisano, Leonetti and Garcea 2017). For the same reason, convergence is judged by
    the steps and not by the residual.
    """
    u = start.copy()
    size_m = float(np.ptp(system.rest))
    terms = stress_terms(system, u, np.zeros_like(u))
    for iteration in range(iterations):
        step = _linear_solution(system, terms, u, load)
        length = float(np.abs(step).max())
        if not np.isfinite(length):
            return u, iteration + 1, False
        terms = stress_terms(system, u, step)
        u = u + step * min(1.0, FARTHEST_STEP * size_m / max(length, 1e-300))
        if length <= tolerance * max(float(np.abs(u).max()), SMALLEST_SWAY * size_m):
            return u, iteration + 1, True
    return u, iterations, False


def _linear_solution(system: ElementSystem, terms: Floats, u: Floats, load: Floats) -> Floats:
    """Step from u that balances the load with the tangent at u; all in internal order.

    An unstable tangent is replaced by the one without the rotation of the stress.
    """
    force, zero, no_mass = np.zeros_like(u), np.zeros_like(u), np.zeros(len(u))
    system.assemble(u, zero, 1.0, no_mass, force)
    add_stress_terms(system, terms)
    try:
        system.solver.factorise(system.values)
    except NotPositiveDefinite:
        system.assemble(u, zero, 1.0, no_mass, force)
        system.solver.factorise(system.values)
    step = load - force
    step[system.free :] = 0
    system.solver.solve(step)
    return step


def _in_mesh_order(system: ElementSystem, u: Floats) -> Floats:
    outer = np.empty_like(u)
    outer[system.order] = u
    return outer
