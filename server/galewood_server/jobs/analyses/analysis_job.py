"""Analysis jobs: comparisons and evaluations of a table against its FEM model."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np
from galewood.check.evaluation import Comparison, Errors, comparison_tracks, nodes_on_wood
from galewood.motion.wind import parse_wind_or_state
from galewood.solid.fem import Place, load_model
from galewood.table import Table, decode

from galewood_server.jobs.analyses.analysis_files import store_result
from galewood_server.jobs.analyses.model_job import with_model
from galewood_server.jobs.progress import JobLease, ProgressReporter
from galewood_server.jobs.stored_files import stored_bytes, stored_path
from galewood_server.settings import Settings
from galewood_server.storage import Job, JobKind, Stores
from galewood_server.stream import pack_msgpack

FORMAT, VERSION = "galewood-comparison", 1


def run_analysis(job_lease: JobLease, kind: JobKind, settings: Settings, stores: Stores) -> None:
    """Run a comparison or an evaluation and store its result. Raises Cancelled, JobFailedError, MeshError."""
    with job_lease.sessions() as session:
        request = dict(session.get_one(Job, job_lease.job_id).settings)
    reporter = ProgressReporter(job_lease)
    request = with_model(job_lease, reporter, request, settings, stores)
    reporter.report("model", 0.0, "Fetching table and model")
    if kind == "comparison":
        _compare(job_lease, reporter, request, stores)
    else:
        from galewood_server.jobs.analyses.evaluation_job import evaluate

        evaluate(job_lease, reporter, request, settings, stores)


def _compare(
    job_lease: JobLease, reporter: ProgressReporter, request: dict[str, Any], stores: Stores
) -> None:
    records = request.get("records_sha256")
    table = decode(
        stored_bytes(stores, "tables", request["table_sha256"]),
        stored_bytes(stores, "records", records) if records else None,
    )
    model = load_model(stored_path(stores, "models", request["model_sha256"]))
    place = Place(**{name: request[name] for name in Place.__dataclass_fields__})

    def on_progress(share: float, message: str) -> None:
        reporter.report("comparing", share, message)

    wind = parse_wind_or_state(request["wind"])
    nodes = nodes_on_wood(table, model)
    comparison = comparison_tracks(table, model, nodes, wind, place, request["frames"], on_progress)
    store_result(job_lease, stores, summary(comparison), pack(comparison, table))


def pack(comparison: Comparison, table: Table) -> bytes:
    """Encode a comparison (spec/formats/comparison.md)."""
    metadata = table.metadata
    document: dict[str, Any] = {
        "format": FORMAT,
        "version": VERSION,
        "frames": len(comparison.pressure_pa),
        "dt_s": float(metadata["dt_s"]),
        "height_m": float(metadata["height_m"]),
        "modes": len(table.mode_scale),
        "pressure_pa": _bytes(comparison.pressure_pa),
        "tracks": {name: _bytes(q) for name, q in comparison.q.items()},
        "sway": _list(comparison.sway),
        "left_out": _list(comparison.left_out),
        "error": _series(comparison.errors),
        "uniform": {
            "sway": _list(comparison.uniform.sway),
            "error": _series(comparison.uniform.errors),
        },
    }
    return pack_msgpack(document)


def summary(comparison: Comparison) -> dict[str, Any]:
    """The maximum of each error over time, relative to the height: in gusts, then in the uniform wind."""
    return {
        "reference_sway": float(comparison.sway.max()),
        "left_out": float(comparison.left_out.max()),
        **_largest(comparison.errors),
        "uniform": {
            "reference_sway": float(comparison.uniform.sway.max()),
            **_largest(comparison.uniform.errors),
        },
    }


def _largest(errors: dict[str, Errors]) -> dict[str, dict[str, float]]:
    return {
        "max_error": {name: float(error.max.max()) for name, error in errors.items()},
        "hausdorff": {name: float(error.hausdorff.max()) for name, error in errors.items()},
    }


def _series(errors: dict[str, Errors]) -> dict[str, dict[str, list[float]]]:
    return {
        name: {kind: _list(values) for kind, values in asdict(error).items()}
        for name, error in errors.items()
    }


def _bytes(values: np.ndarray[Any, Any]) -> bytes:
    return np.ascontiguousarray(values, "<f4").tobytes()


def _list(values: np.ndarray[Any, Any]) -> list[float]:
    return [float(value) for value in values]
