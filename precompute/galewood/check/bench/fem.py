"""Time of one finite-element step, and of the same step with other sparse direct solvers."""

from collections.abc import Callable
from dataclasses import replace
from time import thread_time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from galewood.check.bench.rivals import available_rivals
from galewood.solid.fem import FemModel, Simulator
from galewood.util import Floats

RANDOM_SEED = 3
MAX_RELATIVE_DIFFERENCE = 1e-8
"""Largest accepted ‖x − x_own‖ / ‖x_own‖ of a rival's solution."""


def bench_fem(model: FemModel, points: NDArray[np.int32], *, steps: int = 60) -> dict[str, Any]:
    """Milliseconds of one step (assembly, factorisation, solve, recording at `points`) and of its parts.

    Every figure is a median over `steps` of this thread's CPU time, because other programs may share the
    machine. The solvers take turns on the same matrix and right-hand side. The step is that of the paper's
    Algorithm 2 (backward Euler, one Newton iteration, hence one factorisation and one solve); with a rival it
    is this step less the own factorisation and solve, plus the rival's. The default scheme's step is given as
    well. Raises RuntimeError if a rival's solution differs by more than `MAX_RELATIVE_DIFFERENCE`.
    """
    system = model.system()
    u, w = np.zeros_like(system.rest), np.zeros_like(system.rest)
    force, mass = np.zeros_like(w), model.mass_kg[system.order]
    scale = model.settings.dt_s**2
    load = np.random.default_rng(RANDOM_SEED).normal(size=w.shape)
    b = load[: system.free].ravel()

    def assemble() -> None:
        system.assemble(u, w, scale, mass, force)

    def own_solver(x: Floats) -> None:
        system.solver.factorise(system.values)
        system.solver.solve(x)

    assemble()
    rivals, missing = available_rivals(system.solver.to_scipy(system.values))
    seconds: dict[str, list[float]] = {name: [] for name in ("assembly", "own", *rivals)}
    for _ in range(steps):
        seconds["assembly"].append(_seconds(assemble))
        matrix, x = system.solver.to_scipy(system.values), load.copy()
        seconds["own"].append(_seconds(lambda x=x: own_solver(x)))
        for name, rival in rivals.items():
            prepared, answers = rival.prepare(matrix), list[Floats]()
            seconds[name].append(
                _seconds(lambda rival=rival, a=prepared, out=answers: out.append(rival.solve(a, b)))
            )
            _check_agreement(name, answers[0], x[: system.free].ravel())
    ms = {name: 1e3 * float(np.median(times)) for name, times in seconds.items()}
    step_ms = {
        scheme: 1e3 * _step_seconds(model, scheme, points, steps) for scheme in ("backward-euler", "tr-bdf2")
    }
    return {
        "elements": len(model.elements),
        "degrees_of_freedom": 3 * system.free,
        "step_ms": step_ms["backward-euler"],
        "default_step_ms": step_ms["tr-bdf2"],
        "assembly_ms": ms["assembly"],
        "factorisation_and_solve_ms": ms["own"],
        **compared(step_ms["backward-euler"], ms["own"], {name: ms[name] for name in rivals}),
        "missing_rivals": missing,
    }


def compared(step_ms: float, own_ms: float, rivals_ms: dict[str, float]) -> dict[str, Any]:
    """Every rival's milliseconds and its ratios to the own solver, and the name of the fastest rival.

    `step_ms` is the whole step with the own solver, `own_ms` and `rivals_ms` are factorisation and solve.
    """
    rivals: dict[str, dict[str, float]] = {}
    for name, ms in rivals_ms.items():
        with_rival = step_ms - own_ms + ms
        rivals[name] = {
            "factorisation_and_solve_ms": ms,
            "factorisation_and_solve_ratio": ms / own_ms,
            "step_ms": with_rival,
            "step_ratio": with_rival / step_ms,
        }
    return {"rivals": rivals, "strongest_rival": min(rivals_ms, key=rivals_ms.__getitem__)}


def _check_agreement(name: str, x: Floats, own: Floats) -> None:
    difference = float(np.linalg.norm(x - own) / np.linalg.norm(own))
    if not difference <= MAX_RELATIVE_DIFFERENCE:
        raise RuntimeError(f"the solution by {name} differs from ours by {difference:.1e} (relative)")


def _step_seconds(model: FemModel, scheme: Any, points: NDArray[np.int32], steps: int) -> float:
    """Median seconds of a step including what a table records of it."""
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
