"""The pose in which a tree stands under its own weight."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from precompute.assembly import ElementSystem

Floats = NDArray[np.float64]

LARGEST_SAG = 0.1
"""Sag, as a part of the height, beyond which the given shape is taken to be the one already under load."""


class RestPose(NamedTuple):
    """Displacement (N,3) m of the rest pose, the gravity (N,3) N that the simulation has to carry, and a report."""

    u_m: Floats
    gravity_n: Floats
    report: dict[str, Any]


def gravity_rest_pose(system: ElementSystem, gravity_n: Floats, height_m: float) -> RestPose:
    """Static equilibrium under gravity by Newton's method; nodes in the mesh's order.

    A tree too floppy to stand (its mesh is a drawing, not a structure) would collapse; then the given shape itself is
    taken as the rest pose and gravity as balanced, as a tree that grew under its load has it. The report says which.
    """
    u, iterations, converged = solve_static(system, gravity_n)
    sag = float(np.abs(u).max()) / height_m if np.isfinite(u).all() else float("inf")
    if converged and sag <= LARGEST_SAG:
        return RestPose(u, gravity_n, {"kind": "sagged", "sag_fraction": sag, "iterations": iterations})
    warning = "this tree cannot carry its own weight as drawn; its given shape is taken as the rest pose, gravity balanced"
    report: dict[str, Any] = {"kind": "balanced", "iterations": iterations, "warning": warning}
    return RestPose(np.zeros_like(u), np.zeros_like(gravity_n), report)


def solve_static(
    system: ElementSystem, load_n: Floats, *, iterations: int = 60, tolerance: float = 1e-9
) -> tuple[Floats, int, bool]:
    """Displacement (N,3) under dead loads, Newton steps taken, and whether the residual fell below the tolerance.

    A step that does not lower the residual is halved: the tangent leaves out the rotation's own derivative, so a
    full step can overshoot far from the solution.
    """
    load = load_n[system.order]
    load[system.free :] = 0
    u, force, still = np.zeros_like(load), np.zeros_like(load), np.zeros_like(load)
    no_mass = np.zeros(len(load))
    size = float(np.linalg.norm(load))
    residual = load.copy()
    for iteration in range(iterations):
        if float(np.linalg.norm(residual)) <= tolerance * size:
            return _outer_displacement(system, u), iteration, True
        system.assemble(u, still, 1.0, no_mass, force)
        system.solver.factorise(system.values)
        step = residual.copy()
        system.solver.solve(step)
        u, residual = _damped_step(system, u, step, load, residual)
    return _outer_displacement(system, u), iterations, False


def _damped_step(
    system: ElementSystem, u: Floats, step: Floats, load: Floats, residual: Floats
) -> tuple[Floats, Floats]:
    still, force = np.zeros_like(u), np.zeros_like(u)
    before = float(np.linalg.norm(residual))
    fraction = 1.0
    while True:
        moved = u + fraction * step
        system.force(moved, still, force)
        after = load - force
        after[system.free :] = 0
        if float(np.linalg.norm(after)) < before or fraction < 1 / 32:
            return moved, after
        fraction /= 2


def _outer_displacement(system: ElementSystem, u: Floats) -> Floats:
    outer = np.empty_like(u)
    outer[system.order] = u
    return outer
