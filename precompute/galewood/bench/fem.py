"""How long one finite-element step takes, beside the same step with scipy's general sparse solver."""

from collections.abc import Callable
from dataclasses import replace
from time import thread_time
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import splu

from galewood.fem import ElementSystem, FemModel, Simulator
from galewood.util import Floats


def bench_fem(model: FemModel, points: NDArray[np.int32], *, steps: int = 60) -> dict[str, Any]:
    """Milliseconds of one step (assembly, factorisation, solve, recording at `points`) and of its parts.

    Medians over `steps` of this thread's CPU time (others may share the machine), the two solvers by turns in
    one run. The step is Algorithm 2's (backward Euler, one Newton round), as both solvers can do it; the
    default scheme's whole step is given beside it.
    """
    system = model.system()
    u, w = model.u_rest[system.order], np.zeros((len(system.rest), 3))
    force, mass = np.zeros_like(w), model.mass_kg[system.order]
    scale = model.settings.dt_s**2

    def assemble() -> None:
        system.assemble(u, w, scale, mass, force)

    def own_solver() -> None:
        system.solver.factorise(system.values)
        system.solver.solve(force)

    general = _general_solver(system)
    parts: dict[str, list[float]] = {"assembly": [], "own": [], "splu": []}
    for _ in range(steps):
        parts["assembly"].append(_seconds(assemble))
        matrix = system.solver.to_scipy(system.values)
        parts["own"].append(_seconds(own_solver))
        parts["splu"].append(_seconds(lambda matrix=matrix: general(matrix, force)))
    step = {scheme: _step_seconds(model, scheme, points, steps) for scheme in ("backward-euler", "tr-bdf2")}
    ms = {name: 1e3 * float(np.median(times)) for name, times in parts.items()}
    whole = 1e3 * step["backward-euler"]
    with_splu = whole - ms["own"] + ms["splu"]
    return {
        "elements": len(model.elements),
        "degrees_of_freedom": 3 * system.free,
        "step_ms": whole,
        "step_splu_ms": with_splu,
        "faster_than_splu": with_splu / whole,
        "default_step_ms": 1e3 * step["tr-bdf2"],
        "assembly_ms": ms["assembly"],
        "factorisation_and_solve_ms": ms["own"],
        "splu_ms": ms["splu"],
    }


def _general_solver(system: ElementSystem) -> Callable[[Any, Floats], None]:
    def solve(matrix: Any, force: Floats) -> None:
        force[: system.free] = splu(matrix).solve(force[: system.free].ravel()).reshape(-1, 3)

    return solve


def _step_seconds(model: FemModel, scheme: Any, points: NDArray[np.int32], steps: int) -> float:
    """Median seconds of a step with what the table records of it."""
    simulator = Simulator(replace(model, settings=replace(model.settings, scheme=scheme)))

    def step() -> None:
        simulator.step(np.array([5.0, 2.0]))
        simulator.recorded_force(points)
        simulator.recorded_stiffness(points)

    return float(np.median([_seconds(step) for _ in range(steps)]))


def _seconds(call: Callable[[], None]) -> float:
    begin = thread_time()
    call()
    return thread_time() - begin
