"""The FEM model of a tree whose table was distributed without it: the first analysis computes it."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

from galewood.pipeline.results import BUILTIN_OPTIONS
from galewood.solid.fem import save_model

from galewood_server.jobs.progress import JobLease, ProgressReporter
from galewood_server.jobs.stored_files import mesh_source
from galewood_server.settings import Settings
from galewood_server.storage import (
    TABLE_JOBS,
    Job,
    Stores,
    Tree,
    mark_garbage,
    replace_files,
    store_referenced,
)

PREPARING_MESSAGE = "Preparing the model"


def with_model(
    job_lease: JobLease,
    reporter: ProgressReporter,
    request: dict[str, Any],
    settings: Settings,
    stores: Stores,
) -> dict[str, Any]:
    """The settings of an analysis with the hash of its model, which is computed if there is none.

    Raises Cancelled, JobFailedError, MeshError.
    """
    if request.get("model_sha256"):
        return request
    reporter.report("model", 0.0, PREPARING_MESSAGE)
    return _store(job_lease, stores, request, _compute(job_lease, settings, stores))


def _compute(job_lease: JobLease, settings: Settings, stores: Stores) -> bytes:
    from galewood.pipeline.stages import model_of  # loads the meshing packages
    from galewood.pipeline.tables import BuildOptions

    with job_lease.sessions() as session:
        tree = session.get_one(Job, job_lease.job_id).tree
        options = BuildOptions.model_validate(
            {**usual_options(tree), **tree.options, **settings_of_table(tree)}
        )
        source = mesh_source(stores, tree)
        filename = tree.filename
    model = model_of(source, filename, options, settings.cache_dir)
    with tempfile.TemporaryDirectory(prefix="galewood-model-") as folder:
        path = Path(folder) / "model.npz"
        save_model(model, path)
        return path.read_bytes()


def usual_options(tree: Tree) -> dict[str, Any]:
    """Options of the builds of a tree, unless it or a job has others."""
    return BUILTIN_OPTIONS if tree.builtin or tree.grown else {}


def settings_of_table(tree: Tree) -> dict[str, Any]:
    """The settings of the build that computed the tree's table."""
    done = [job.settings for job in tree.jobs if job.kind in TABLE_JOBS and job.state == "done"]
    return done[-1] if done else {}


def _store(job_lease: JobLease, stores: Stores, request: dict[str, Any], model: bytes) -> dict[str, Any]:
    """Store the model for this and later analyses of the same table."""
    sha256 = stores.models.put(model)
    with job_lease.sessions.begin() as session:
        job_lease.check(session)
        job = session.get_one(Job, job_lease.job_id)
        store_referenced(session, stores, "models", model)
        job.settings = {**request, "model_sha256": sha256}
        if job.tree.table_sha256 == request["table_sha256"]:
            replace_files(session, job.tree, {"model_sha256": sha256})
        else:
            mark_garbage(session, "models", sha256)
        return dict(job.settings)
