"""CPU time of a table's samples: the paper's 6,480 steps with the fast elements and with the reference."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from time import thread_time
from typing import Any

import numpy as np

from galewood.pipeline.sampling import SampleWind, design_wind, sample_trajectory, sample_winds
from galewood.pipeline.tables import BuildOptions
from galewood.solid.fem import FemModel, Simulator
from galewood.solid.model import reference_model, tree_model
from galewood.solid.skeleton import sampled_elements
from galewood.tree import import_mesh_sandboxed

OnProgress = Callable[[float, str], None]
REFERENCE_FRAMES, QUICK_REFERENCE_FRAMES = 180, 20
QUICK_WINDS = 3


def bench_samples(
    mesh: Path, options: BuildOptions, cache_dir: Path, *, quick: bool, on_progress: OnProgress
) -> Any:
    """CPU seconds of all cosine winds with the fast elements and with the reference, on one core each.

    The fast elements simulate every wind and record what a table records (``quick``: three winds,
    extrapolated). The reference simulates 180 frames of one wind (``quick``: 20), extrapolated to all frames:
    every step costs the same.
    """
    on_progress(0.0, "Preparing the tree")
    fast, reference, points = prepared(mesh, options, cache_dir)
    dt_s, exponent = options.fem.dt_s, fast.streamlined_exponent
    wind = design_wind(Simulator(fast), options.design_speed_m_s, _height_m(fast), dt_s, exponent)
    winds = [w for w in sample_winds(wind.speed_m_s, dt_s, exponent) if w.name.startswith("cosine")]
    chosen = winds[:: len(winds) // QUICK_WINDS] if quick else winds
    frames = sum(len(w.pressure_pa) for w in winds)
    fast_s = _seconds(
        fast, chosen, points, lambda f: on_progress(0.1 + 0.4 * f, "Sampling with the fast elements")
    )
    cut = QUICK_REFERENCE_FRAMES if quick else REFERENCE_FRAMES
    one = [SampleWind("reference", 0.0, winds[-1].pressure_pa[:cut])]
    slow_s = _seconds(
        reference, one, points, lambda f: on_progress(0.5 + 0.5 * f, "Sampling with the reference")
    )
    run = sum(len(w.pressure_pa) for w in chosen)
    return {
        "tree": mesh.stem,
        "samples": frames,
        "fast_cpu_s": fast_s * frames / run,
        "fast_samples_run": run,
        "reference_cpu_s": slow_s * frames / cut,
        "reference_samples_run": cut,
        "faster": (slow_s / cut) / (fast_s / run),
        "elements": len(fast.elements),
    }


def prepared(mesh: Path, options: BuildOptions, cache_dir: Path) -> tuple[FemModel, FemModel, Any]:
    """A tree's model with fast elements, that with quadratic elements, and the vertices to record (k,)."""
    tree, _ = import_mesh_sandboxed(mesh.read_bytes(), mesh.name, options)
    made = tree_model(tree, None, options.target_tets, cache_dir, options.fem)
    points = np.unique(made.tets.tets[sampled_elements(made.tets, made.skeleton, options.sampled_elements)])
    reference = reference_model(made.tets, made.skeleton, made.wood, made.lumped, options.fem)
    return made.fem, reference, points


def _height_m(model: FemModel) -> float:
    return float(np.ptp(model.nodes_m[:, 1]))


def _seconds(
    model: FemModel, winds: Sequence[SampleWind], points: Any, on_progress: Callable[[float], None]
) -> float:
    """CPU seconds of this thread. A first step, which may compile, is not counted."""
    simulator, dt_s = Simulator(model), model.settings.dt_s
    sample_trajectory(simulator, SampleWind("first", 0.0, winds[0].pressure_pa[:1]), points, dt_s)
    spent = 0.0
    for k, wind in enumerate(winds):
        begun = thread_time()
        sample_trajectory(simulator, wind, points, dt_s, lambda f, k=k: on_progress((k + f) / len(winds)))
        spent += thread_time() - begun
    return spent
