"""The pose in which a tree stands under its own weight."""

from typing import Any, NamedTuple

import numpy as np

from galewood.fem.assembly import ElementSystem
from galewood.util import Floats

LARGEST_SAG = 0.1
"""Sag, as a part of the height, beyond which the given shape is taken to be the one already under load."""


class RestPose(NamedTuple):
    """Displacement (N,3) m of the rest pose, the gravity (N,3) N that the simulation has to carry, and a
    report.
    """

    u_m: Floats
    gravity_n: Floats
    report: dict[str, Any]


def gravity_rest_pose(system: ElementSystem, gravity_n: Floats, height_m: float) -> RestPose:
    """Static equilibrium under gravity by Newton's method; nodes in the mesh's order.

    A tree too floppy to stand (its mesh is a drawing, not a structure) would collapse; then the given shape
    itself is taken as the rest pose and gravity as balanced, as a tree that grew under its load has it. The
    report says which.
    """
    u, iterations, converged = solve_static(system, gravity_n)
    sag = float(np.abs(u).max()) / height_m if np.isfinite(u).all() else float("inf")
    if converged and sag <= LARGEST_SAG:
        return RestPose(u, gravity_n, {"kind": "sagged", "sag_fraction": sag, "iterations": iterations})
    return balanced_pose(gravity_n, "it sags without end")


def balanced_pose(gravity_n: Floats, why: str) -> RestPose:
    """The given shape as the rest pose, with gravity balanced."""
    warning = (
        f"this tree cannot carry its own weight as drawn ({why}); its given shape is taken as the rest pose"
    )
    return RestPose(
        np.zeros_like(gravity_n), np.zeros_like(gravity_n), {"kind": "balanced", "warning": warning}
    )


def solve_static(
    system: ElementSystem, load_n: Floats, *, iterations: int = 60, tolerance: float = 1e-9
) -> tuple[Floats, int, bool]:
    """Displacement (N,3) under dead loads, Newton steps taken, and whether the steps fell below the
    tolerance.

    The tangent leaves out the rotations' own derivative, that is what the load gains from the sway it causes
    (P–Δ): for a slender tree the steps then shrink slowly, by the load's part of the buckling load, which is
    measured from two steps and summed to its end (Aitken). The residual is no guide: a first step in bending
    stretches everything.
    """
    load = load_n[system.order]
    load[system.free :] = 0
    u, force, still = np.zeros_like(load), np.zeros_like(load), np.zeros_like(load)
    no_mass, before = np.zeros(len(load)), np.zeros_like(load)
    farthest = 0.2 * float(np.ptp(system.rest))
    for iteration in range(iterations):
        system.assemble(u, still, 1.0, no_mass, force)
        step = load - force
        step[system.free :] = 0
        system.solver.factorise(system.values)
        system.solver.solve(step)
        length = float(np.abs(step).max())
        if not np.isfinite(length):
            return _outer_displacement(system, u), iteration, False
        u += step * min(_tail(step, before, iteration), farthest / max(length, 1e-300))
        before = step
        if length <= tolerance * float(np.abs(u).max()):
            return _outer_displacement(system, u), iteration + 1, True
    return _outer_displacement(system, u), iterations, False


def _tail(step: Floats, before: Floats, iteration: int) -> float:
    """Sum of the geometric series that two steps in a row begin, every third step."""
    if iteration % 3 or not iteration:
        return 1.0
    ratio = float(np.vdot(step, before)) / max(float(np.vdot(before, before)), 1e-300)
    return 1 / (1 - ratio) if 0.1 < ratio < 0.95 else 1.0


def _outer_displacement(system: ElementSystem, u: Floats) -> Floats:
    outer = np.empty_like(u)
    outer[system.order] = u
    return outer
