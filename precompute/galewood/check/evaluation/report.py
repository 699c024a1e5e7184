"""Implements ``galewood evaluate``: reads the files, runs the evaluation and collects its figures."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from galewood.check.evaluation.evaluate import OnProgress, evaluate_table
from galewood.check.evaluation.gusts import evaluate_in_gusts
from galewood.check.evaluation.long_run import long_run, play_beyond_range
from galewood.check.evaluation.model_file import SourceError
from galewood.check.evaluation.plot import plot_errors
from galewood.check.evaluation.source import source_of
from galewood.options import EvaluationOptions
from galewood.table import decode

DEFINITIONS = {
    "gusts": "winds whose gusts differ within the crown, as the page plays them; the reference solution "
    "feels them at each of its nodes",
    "uniform": "winds that are the same over the whole crown",
    "rms_error_of_rms_sway": "root mean square of the nodes' distance from the reference solution, over that "
    "of their sway about the mean pose",
    "branches": "motion of the outer half of the crown relative to the trunk, over that of the reference "
    "solution (branches_m): 1 is right, 0 are branches that only follow the trunk",
    "pressure_ratio": "strongest pressure at the tree over that of the table, before it was compressed",
    "max_error": "largest distance of a vertex from the reference solution, over the height",
    "rms_error": "root mean square of that distance over all vertices and frames, over the height",
    "max_error_of_sway": "largest error over the largest displacement of the run (reference_sway × height)",
    "late_error": "largest error in the last sixth of the run, over the height",
    "growth": "largest error of the second half over that of the first, after the lead-in of repeating winds",
    "growth_of_sway": "growth with each half's error divided by its sway; null where a half barely moves",
    "hausdorff": "symmetric Hausdorff distance of the wood's displaced vertices over the height, by frame",
    "rendered": "the same figures at the render vertices, which the viewer moves with their nodes",
    "floor": "error without that of the method: truncation of the modes, and vertices that share a node",
    "converged": "largest errors over the height: elements against steps a quarter as long, table, and total",
    "extrapolation_ratio": "sway or pressure over the largest sampled value; above 1: extrapolation",
}


def run_evaluation(
    table: Path,
    mesh: Path | None,
    model: Path | None,
    options: EvaluationOptions,
    cache_dir: Path,
    on_progress: OnProgress,
    *,
    plot: Path | None,
    reference_dir: Path | None = None,
    records: Path | None = None,
) -> dict[str, Any]:
    """Evaluate a table file and return JSON-able figures.

    Reference runs are cached in ``reference_dir``, by default in ``cache_dir``. ``plot`` is a picture to
    write, ``records`` the table's records file if it has one; without records the paper's methods are left
    out. Raises TableError, SourceError, MeshError, and FloatingPointError if a reference simulation diverges.
    """
    decoded = decode(table.read_bytes(), records.read_bytes() if records else None)
    drawn, references = mesh or mesh_of(table), reference_dir or cache_dir
    source = source_of(
        decoded, drawn, cache_dir, share(on_progress, 0.0, 0.1), model=model, workers=options.workers
    )
    middle = 0.6 if options.long else 1.0
    in_gusts = evaluate_in_gusts(decoded, source, options, references, share(on_progress, 0.1, 0.5 * middle))
    uniform = evaluate_table(decoded, source, options, references, share(on_progress, 0.5 * middle, middle))
    found: dict[str, Any] = {
        "species": decoded.metadata.get("species"),
        "height_m": decoded.metadata["height_m"],
        "design_speed_m_s": decoded.metadata["design_speed_m_s"],
        "seed": options.seed,
        "frames": options.frames,
        "gusts": in_gusts,
        "uniform": uniform,
        "definitions": DEFINITIONS,
    }
    if plot is not None:
        plot_errors(in_gusts, uniform, plot)
    if options.long:
        found["long"] = long_run(
            decoded, source, cache_dir, share(on_progress, middle, 1.0),
            frames=options.long, sway=options.sway or 0.1, seed=options.seed,
        )  # fmt: skip
        found["beyond"] = play_beyond_range(decoded, source)
    return found


def sentences(found: dict[str, Any]) -> list[str]:
    """The main figures of the default method in words, those in gusts first."""
    lines = ["In gusts, which differ within the crown, as the page plays them:"]
    for name, case in found["gusts"].items():
        figures, branches = case["modal"], case["modal"]["branches"]
        line = (
            f"  {name}: sway {_percent(case['reference_sway'])} of the height; error "
            f"{_percent(figures['rms_error_of_rms_sway'])} of the sway (root mean squares), at most "
            f"{_percent(figures['max_error'])} of the height"
        )
        if branches is not None:
            line += f"; branches move {branches:.2f} times as far as in the finite elements"
        lines.append(line)
    lines.append("In winds that are the same over the whole crown:")
    for name, methods in found["uniform"].items():
        sway = methods["rest-pose"]["reference_sway"]
        lines.append(
            f"  {name}: sway {_percent(sway)} of the height; error at most "
            f"{_percent(methods['modal']['max_error'])} of the height"
        )
    return lines


def _percent(share_: float) -> str:
    return f"{float(f'{100 * share_:.2g}'):g} %"


def mesh_of(table: Path) -> Path:
    """The render mesh that ``galewood build`` writes beside a table. Raises SourceError."""
    beside = table.with_suffix(".glb")
    if not beside.exists():
        raise SourceError(f"{beside} does not exist: give the mesh of the table with --mesh")
    return beside


def share(on_progress: OnProgress, first: float, last: float) -> OnProgress:
    """Map progress 0..1 to ``first``..``last`` of the whole."""
    return lambda fraction, message: on_progress(first + (last - first) * fraction, message)
