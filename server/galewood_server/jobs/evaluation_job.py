"""The work of an evaluation: what `galewood evaluate` runs, on the stored table, model and mesh."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

from galewood.evaluation import SourceError, run_evaluation
from galewood.table import read_metadata

from galewood_server.jobs.analysis_files import PLOT, finish
from galewood_server.jobs.reporting import JobFailedError, JobLease, Reporter
from galewood_server.settings import Settings
from galewood_server.storage import Stores

STRENGTH = 0.65
"""Peak of the winds over the design speed where nothing was asked, as in `galewood evaluate`."""
SHOWN = ("max_error", "rms_error", "late_error", "growth", "extrapolation_ratio")


def evaluate(
    job_lease: JobLease, reporter: Reporter, request: dict[str, Any], settings: Settings, stores: Stores
) -> None:
    """Evaluate and store. What ran is kept beside until the job has ended, so that a restart goes on."""
    folder = settings.analysis_folder(job_lease.job_id)
    folder.mkdir(parents=True, exist_ok=True)
    found = _figures(folder, reporter, request, settings, stores)
    # `growth` is null where nothing grows; a figure that is no number would be a fault worth failing for
    report = json.dumps(found, allow_nan=False, default=float).encode()
    pictures = {PLOT: (folder / PLOT).read_bytes()}
    finish(job_lease, stores, main_figures(found["winds"]), report, pictures)
    shutil.rmtree(folder, ignore_errors=True)


def _figures(
    folder: Path, reporter: Reporter, request: dict[str, Any], settings: Settings, stores: Stores
) -> dict[str, Any]:
    table, mesh = stores.tables.path(request["table_sha256"]), folder / "tree.glb"
    mesh.write_bytes(stores.meshes.get(request["mesh_sha256"]))

    def on_progress(share: float, message: str) -> None:
        reporter.report("evaluating", share, message)

    try:
        return run_evaluation(
            table, mesh, stores.models.path(request["model_sha256"]), settings.cache_dir, on_progress,
            plot=folder / PLOT, frames=request["frames"], strength=strength_of(table, request),
            sway=request.get("sway"), seed=request["seed"], long=0, workers=1, reference_dir=folder,
        )  # fmt: skip
    except SourceError as error:
        raise JobFailedError("The table is not of the model that is kept. Compute the tree again.") from error
    except FloatingPointError as error:
        raise JobFailedError("The finite elements do not bear such wind. Ask for less.") from error


def strength_of(table: Path, request: dict[str, Any]) -> float:
    """Peak of the winds over the table's design speed."""
    if "speed_m_s" not in request:
        return STRENGTH
    return float(request["speed_m_s"]) / float(read_metadata(table.read_bytes())["design_speed_m_s"])


def main_figures(winds: dict[str, Any]) -> dict[str, Any]:
    """By wind: how far the tree swayed, what no method can mend, and each method's main figures."""
    return {
        wind: {
            "sway": methods["rest-pose"]["reference_sway"],
            "floor": methods["floor"]["truncation"],
            "methods": {
                name: {figure: figures[figure] for figure in SHOWN}
                for name, figures in methods.items()
                if name != "floor"
            },
        }
        for wind, methods in winds.items()
    }
