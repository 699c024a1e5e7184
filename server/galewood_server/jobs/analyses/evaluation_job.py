"""Evaluation job: runs `galewood evaluate` on the stored table, model and mesh."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

from galewood.check.evaluation import SourceError, run_evaluation
from galewood.options import EVALUATION_PEAK_RATIO, METHOD_NAMES, EvaluationOptions
from galewood.table import read_metadata

from galewood_server.jobs.analyses.analysis_files import PLOT_FILE, store_result
from galewood_server.jobs.progress import JobFailedError, JobLease, ProgressReporter
from galewood_server.jobs.stored_files import stored_bytes, stored_path
from galewood_server.settings import Settings
from galewood_server.storage import Stores

GUST_FIGURES = ("rms_error_of_rms_sway", "max_error", "branches", "extrapolation_ratio")
MAIN_FIGURES = ("max_error", "rms_error", "late_error", "growth", "extrapolation_ratio")


def evaluate(
    job_lease: JobLease,
    reporter: ProgressReporter,
    request: dict[str, Any],
    settings: Settings,
    stores: Stores,
) -> None:
    """Evaluate a table and store the result. Finished runs are kept until the end, to resume after a restart.

    Raises Cancelled, JobFailedError.
    """
    folder = settings.analysis_folder(job_lease.job_id)
    folder.mkdir(parents=True, exist_ok=True)
    figures = _run(folder, reporter, request, settings, stores)
    # `growth` is null if nothing grows; NaN would be a defect, hence allow_nan=False
    report = json.dumps(figures, allow_nan=False, default=float).encode()
    pictures = {PLOT_FILE: (folder / PLOT_FILE).read_bytes()}
    store_result(job_lease, stores, main_figures(figures), report, pictures)
    shutil.rmtree(folder, ignore_errors=True)


def _run(
    folder: Path, reporter: ProgressReporter, request: dict[str, Any], settings: Settings, stores: Stores
) -> dict[str, Any]:
    table, mesh = stored_path(stores, "tables", request["table_sha256"]), folder / "tree.glb"
    mesh.write_bytes(stored_bytes(stores, "meshes", request["mesh_sha256"]))
    model, records = stored_path(stores, "models", request["model_sha256"]), request.get("records_sha256")

    def on_progress(share: float, message: str) -> None:
        reporter.report("evaluating", share, message)

    options = EvaluationOptions(
        frames=request["frames"], strength=strength_of(table, request), sway=request.get("sway"),
        seed=request["seed"], workers=1,
    )  # fmt: skip
    try:
        return run_evaluation(
            table, mesh, model, options, settings.cache_dir, on_progress, plot=folder / PLOT_FILE,
            reference_dir=folder,
            records=stored_path(stores, "records", records) if records else None,
        )  # fmt: skip
    except SourceError as error:
        raise JobFailedError("The table does not match the stored model. Compute the tree again.") from error
    except FloatingPointError as error:
        raise JobFailedError(
            "The simulation is unstable under this wind. Reduce the wind strength."
        ) from error


def strength_of(table: Path, request: dict[str, Any]) -> float:
    """Peak wind speed relative to the table's design speed."""
    if "speed_m_s" not in request:
        return EVALUATION_PEAK_RATIO
    return float(request["speed_m_s"]) / float(read_metadata(table.read_bytes())["design_speed_m_s"])


def main_figures(figures: dict[str, Any]) -> dict[str, Any]:
    """In gusts, then in uniform winds: by wind, sway of the reference solution and main figures by method."""
    in_gusts = {
        wind: {
            "sway": case["reference_sway"],
            "mean_speed_m_s": case["mean_speed_m_s"],
            "methods": {
                name: {figure: case[name][figure] for figure in GUST_FIGURES}
                for name in METHOD_NAMES
                if name in case
            },
        }
        for wind, case in figures["gusts"].items()
    }
    uniform = {
        wind: {
            "sway": methods["rest-pose"]["reference_sway"],
            "floor": methods["floor"]["truncation"],
            "methods": {
                name: {figure: found[figure] for figure in MAIN_FIGURES}
                for name, found in methods.items()
                if name != "floor"
            },
        }
        for wind, methods in figures["uniform"].items()
    }
    return {"gusts": in_gusts, "uniform": uniform}
