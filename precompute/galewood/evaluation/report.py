"""What ``galewood evaluate`` does, from files to figures."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from galewood.evaluation.evaluate import OnProgress, evaluate_table
from galewood.evaluation.long_run import beyond, long_run
from galewood.evaluation.plot import plot_errors
from galewood.evaluation.source import SourceError, source_of
from galewood.table import decode

DEFINITIONS = {
    "max_error": "largest distance of a vertex from where the finite elements have it, over the height",
    "rms_error": "root mean square of that distance over all vertices and frames, over the height",
    "max_error_of_sway": "the same over the largest displacement in this run (reference_sway × height)",
    "late_error": "largest error in the last sixth of the run, over the height",
    "growth": "largest error of the second half over the first's, after the lead-in of winds that repeat",
    "growth_of_sway": "the same with each half's error over its own sway; none where a half hardly moves",
    "hausdorff": "symmetric Hausdorff distance of the wood's displaced vertices, by frame, over the height",
    "rendered": "the same figures for the render vertices as the viewer moves them, by nodes",
    "floor": "without the method's own error: truncation of the modes, and vertices that share a node",
    "extrapolation_ratio": "sway or pressure over its largest sampled value; above 1 it is extrapolated",
}


def run_evaluation(
    table: Path,
    mesh: Path | None,
    model: Path | None,
    cache_dir: Path,
    on_progress: OnProgress,
    *,
    plot: Path | None,
    frames: int,
    strength: float,
    sway: float | None,
    seed: int,
    long: int,
    workers: int,
    reference_dir: Path | None = None,
) -> dict[str, Any]:
    """Everything asked for, as JSON-able figures.

    The reference runs are kept in ``reference_dir``, else in the cache. Raises SourceError, MeshError, and
    FloatingPointError under a wind that the finite elements cannot follow.
    """
    decoded = decode(table.read_bytes())
    source = source_of(
        decoded, mesh or mesh_of(table), cache_dir, share(on_progress, 0.0, 0.1), model=model, workers=workers
    )
    middle = 0.4 if long else 1.0
    winds = evaluate_table(
        decoded, source, frames, reference_dir or cache_dir, share(on_progress, 0.1, middle),
        strength=strength, sway=sway, seed=seed, workers=workers,
    )  # fmt: skip
    found: dict[str, Any] = {
        "species": decoded.metadata.get("species"),
        "height_m": decoded.metadata["height_m"],
        "design_speed_m_s": decoded.metadata["design_speed_m_s"],
        "seed": seed,
        "frames": frames,
        "definitions": DEFINITIONS,
        "winds": winds,
    }
    if plot is not None:
        plot_errors(winds, plot)
    if long:
        sub_progress = share(on_progress, middle, 1.0)
        found["long"] = long_run(
            decoded, source, cache_dir, sub_progress, frames=long, sway=sway or 0.1, seed=seed
        )
        found["beyond"] = beyond(decoded, source)
    return found


def mesh_of(table: Path) -> Path:
    """The render mesh that ``galewood build`` writes beside a table."""
    beside = table.with_suffix(".glb")
    if not beside.exists():
        raise SourceError(f"{beside} is not there: name the mesh of the table (--mesh)")
    return beside


def share(on_progress: OnProgress, first: float, last: float) -> OnProgress:
    """A tick that moves through a part of the whole."""
    return lambda fraction, message: on_progress(first + (last - first) * fraction, message)
