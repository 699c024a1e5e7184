"""Compares a folder of trees with measured frequencies and damping: runs the models, writes the report."""

from __future__ import annotations

import json
import re
import signal
import time
from collections.abc import Callable, Iterator
from concurrent.futures import as_completed
from contextlib import ExitStack
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from galewood.check.field.bending import bending_of, is_bending
from galewood.check.field.measurements import FieldError, Measurement, is_table, read_measurements
from galewood.check.field.page import html_page
from galewood.check.field.plots import bending_figure, scatter_figure
from galewood.check.field.release import pull_and_release
from galewood.check.field.simulated import dbh_cm_of, mesh_of_file, simulated_tree
from galewood.check.field.summary import summarised
from galewood.check.sway import main_sway_mode
from galewood.options import BuildRequest
from galewood.tree import TreeMesh
from galewood.util import Cancelled, MeshError, WorkerPool, write_atomically

SUFFIXES = (".glb", ".gltf", ".obj", ".ply", ".stl", ".mat", ".csv")
OUTPUT_FOLDER = "field-report"
SCANS = (".mat", ".csv")
OnProgress = Callable[[float, str], None]


@dataclass(frozen=True, kw_only=True)
class FieldOptions:
    """Options of a comparison.

    ``measurements`` is the table, by default the only table of frequencies in the folder; ``out`` the
    folder for the report, by default "field-report" in the folder of the trees. ``trees`` are the options of
    every tree; the table overrides its species, height and foliage. ``sway`` is the share of the height to
    which each tree is pulled.
    """

    measurements: Path | None = None
    out: Path | None = None
    workers: int = 1
    trees: BuildRequest = field(default_factory=BuildRequest)
    damping: bool = True
    sway: float = 0.03
    cache_dir: Path = Path("data/cache")


@dataclass(frozen=True)
class Task:
    """One row of the table with its file."""

    row: Measurement
    path: Path
    options: FieldOptions


def run_field(
    folder: Path, options: FieldOptions, on_progress: OnProgress = lambda share, message: None
) -> dict[str, Any]:
    """Compute every measured tree of a folder; write and return the report.

    Writes report.json, report.html, plots, and trees/NAME-SEASON.json as soon as a tree is finished. A
    tree that fails is listed and does not stop the others. KeyboardInterrupt, or Cancelled raised by
    ``on_progress``, ends the run; the report then holds the finished trees, and "interrupted" is true. Raises
    FieldError if the folder or its table cannot be used.
    """
    table = options.measurements or found_table(folder)
    rows = read_measurements(table)
    tasks, missing = matched(folder, rows, table, options)
    if not tasks:
        raise FieldError(f"none of the {len(rows)} trees of {table.name} has a file in {folder}")
    output = options.out or folder / OUTPUT_FOLDER
    output.mkdir(parents=True, exist_ok=True)
    trees: list[dict[str, Any]] = []
    interrupted = False
    try:
        for tree in _results(tasks, options.workers):
            trees.append(tree)
            name = re.sub(r"[^\w.-]", "_", f"{tree['tree']}-{tree['season']}.json")
            write_atomically(output / "trees" / name, _json(tree))
            on_progress(len(trees) / len(tasks), f"{len(trees)} of {len(tasks)}: {tree['tree']}")
    except (KeyboardInterrupt, Cancelled):
        interrupted = True
    report = _report(folder, table, tasks, trees, missing, options, interrupted)
    write_atomically(output / "report.json", _json(report))
    plots = (output / "scatter.png", output / "bending.png")
    if any(tree["frequency_hz"] is not None for tree in report["trees"]):
        scatter_figure(report).savefig(plots[0], dpi=110)
    if report["bending"]:
        bending_figure(report).savefig(plots[1], dpi=110)
    write_atomically(output / "report.html", html_page(report, plots).encode())
    return report


def found_table(folder: Path) -> Path:
    """The only CSV file of a folder with columns for trees and measurements. Raises FieldError."""
    if not folder.is_dir():
        raise FieldError(f"{folder} is not a folder")
    tables = [path for path in sorted(folder.glob("*.csv")) if is_table(path)]
    if len(tables) != 1:
        what = "no table" if not tables else "several tables (" + ", ".join(p.name for p in tables) + ")"
        raise FieldError(
            f"{folder} has {what} of measurements: a CSV file with the columns tree and frequency_hz. "
            "Name it with --measurements"
        )
    return tables[0]


def matched(
    folder: Path, rows: list[Measurement], table: Path, options: FieldOptions
) -> tuple[list[Task], list[dict[str, Any]]]:
    """The tasks of all rows with a file, and the rows without one."""
    files = [p for p in sorted(folder.iterdir()) if p.suffix.lower() in SUFFIXES and p != table]
    tasks: list[Task] = []
    missing: list[dict[str, Any]] = []
    for row in rows:
        exact = [p for p in files if p.name.lower() == row.tree.lower()]
        same = exact or [p for p in files if p.stem.lower() == row.tree.lower()]
        if len(same) == 1:
            tasks.append(Task(row, same[0], options))
        else:
            why = "no file of this name" if not same else "several files: " + ", ".join(p.name for p in same)
            missing.append({"tree": row.tree, "line": row.line, "why": why})
    return tasks, missing


def computed(task: Task) -> dict[str, Any]:
    """One tree: its row, the model's figures, or an error."""
    begin = time.perf_counter()
    row = {k: v for k, v in asdict(task.row).items() if k != "line"}
    figures: dict[str, Any] = {**row, "file": task.path.name}
    try:
        figures |= _modelled(task)
    except MeshError as error:
        figures["error"] = f"{error.title} {error.hint}"
    except Exception as error:  # a tree that fails must not stop the others
        figures["error"] = f"{type(error).__name__}: {error}"
    return {**figures, "seconds": round(time.perf_counter() - begin, 1)}


def _modelled(task: Task) -> dict[str, Any]:
    options, row = task.options, task.row
    scan = task.path.suffix.lower() in SCANS
    chosen = options_of(row, scan, options.trees)
    mesh = mesh_of_file(task.path, chosen)
    found: dict[str, Any] = {
        "wood": chosen.wood_of(mesh.species).name,
        "model_height_m": mesh.height_m,
        "model_dbh_cm": dbh_cm_of(mesh),
        "warnings": list(mesh.report.get("warnings", [])),
    }
    if is_bending(row):
        found |= bending_of(row, mesh, chosen)
    return found if row.frequency_hz is None else found | _frequencies(mesh, chosen, options)


def _frequencies(mesh: TreeMesh, chosen: BuildRequest, options: FieldOptions) -> dict[str, Any]:
    """Frequencies and damping of a tree's finite elements."""
    tree = simulated_tree(mesh, chosen, options.cache_dir)
    mode = main_sway_mode(tree.fem)
    found: dict[str, Any] = {
        "wood": tree.fem.report["wood"],
        "model_mass_kg": float(tree.fem.mass_kg.sum()),
        "model_frequency_hz": mode.frequency_hz,
        "model_lowest_hz": mode.lowest_hz,
        "model_mode": mode.number,
        "model_mode_mass_share": mode.mass_share,
        "rest_pose": tree.fem.report["rest_pose"]["kind"],
        "warnings": tree.warnings,
    }
    return found | (_damping(tree.fem, options.sway) if options.damping else {})


def options_of(row: Measurement, scan: bool, given: BuildRequest) -> BuildRequest:
    """The options of one tree: the given ones, and what the table says of it."""
    chosen: dict[str, Any] = given.model_dump(exclude_unset=True) | {
        "species": row.species,
        "height_m": None if scan else row.height_m,
        "dbh_cm": (row.dbh_cm or given.dbh_cm) if scan else None,
        "foliage": row.season,
        "min_radius_mm": given.min_radius_mm if scan else None,
        "wood": None if row.species else given.wood,
    }
    return BuildRequest.model_validate(chosen)


def _damping(model: Any, sway: float) -> dict[str, Any]:
    """Damping of a pull and release; a failure leaves the frequencies."""
    try:
        decay = pull_and_release(model, sway=sway).decay
    except (ArithmeticError, ValueError) as error:
        return {"damping_error": str(error)}
    return {
        "model_damping_ratio": decay.ratio,
        "model_damping_ratio_small": decay.ratio_at(0.0),
        "model_release_hz": decay.frequency_hz,
    }


def _results(tasks: list[Task], workers: int) -> Iterator[dict[str, Any]]:
    """Results as they are finished: in this process, or in worker processes."""
    if workers <= 1 or len(tasks) == 1:
        for task in tasks:
            yield computed(task)
        return
    with ExitStack() as stack:
        pool = stack.enter_context(WorkerPool(min(workers, len(tasks))))
        for future in as_completed([pool.start(_in_worker, task) for task in tasks]):
            yield future.result()


def _in_worker(task: Task) -> dict[str, Any]:
    """`computed` in a worker, which leaves Ctrl-C to its parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    return computed(task)


def _report(
    folder: Path,
    table: Path,
    tasks: list[Task],
    trees: list[dict[str, Any]],
    missing: list[dict[str, Any]],
    options: FieldOptions,
    interrupted: bool,
) -> dict[str, Any]:
    order = {(task.row.tree, task.row.season): k for k, task in enumerate(tasks)}
    trees = sorted(trees, key=lambda tree: order[tree["tree"], tree["season"]])
    used = {task.path for task in tasks} | {table}
    unmeasured = [p.name for p in sorted(folder.iterdir()) if p.suffix.lower() in SUFFIXES and p not in used]
    finished = [tree for tree in trees if "error" not in tree]
    return {
        "table": table.name,
        "options": {
            "min_radius_mm": options.trees.min_radius_mm,
            "wood": options.trees.wood.name if options.trees.wood else None,
            "sway": options.sway if options.damping else None,
            "target_tets": options.trees.target_tets,
            "root_stiffness_nm_rad": options.trees.root_stiffness_nm_rad,
        },
        "trees": finished,
        "failed": [tree for tree in trees if "error" in tree],
        "without_file": missing,
        "not_measured": unmeasured,
        "unfinished": len(tasks) - len(trees),
        "interrupted": interrupted,
        **summarised(finished),
    }


def _json(value: dict[str, Any]) -> bytes:
    return (json.dumps(value, indent=2, default=float) + "\n").encode()
