"""Build job: computes the table of a tree and stores it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from galewood.options import BuildRequest
from galewood.pipeline import BuildOptions, BuildResult, Progress, build_options
from sqlalchemy import update

from galewood_server.jobs.artefact_publisher import ArtefactPublisher
from galewood_server.jobs.cluster.blob_transfer import BlobTransfer
from galewood_server.jobs.cluster.dask_runner import DaskRunner
from galewood_server.jobs.progress import JobLease, ProgressReporter
from galewood_server.jobs.queue import end_job
from galewood_server.jobs.table_fingerprint import fingerprint
from galewood_server.settings import Settings
from galewood_server.storage import (
    HASH_COLUMNS,
    Job,
    Sessions,
    Stores,
    Tree,
    mark_replaced,
    store_referenced,
    utc_now,
)

Build = Callable[..., BuildResult]


@dataclass(frozen=True)
class BuildInputs:
    """The inputs of a build, read when the job starts."""

    tree_id: str
    source: bytes
    filename: str
    options: BuildOptions
    fingerprint: str


def read_build_inputs(sessions: Sessions, stores: Stores, job_id: str) -> BuildInputs:
    """The inputs of a job: its tree's mesh and options, overridden by the job's settings."""
    with sessions() as session:
        job = session.get_one(Job, job_id)
        tree = job.tree
        return BuildInputs(
            tree_id=tree.id,
            source=stores.sources.get(tree.source_sha256),
            filename=tree.filename,
            options=build_options(BuildRequest.model_validate({**tree.options, **job.settings})),
            fingerprint=fingerprint(tree.source_sha256, tree.options, job.settings),
        )


def run_build(job_lease: JobLease, address: str, settings: Settings, stores: Stores, build: Build) -> None:
    """Compute and store a table. Raises MeshError, EngineLostError, Cancelled."""
    inputs = read_build_inputs(job_lease.sessions, stores, job_lease.job_id)
    reporter = ProgressReporter(job_lease)
    transfer = BlobTransfer(settings.store_url, job_lease.job_id) if settings.store_url else None
    runner = DaskRunner(address, settings.cancel_flag(job_lease.job_id), reporter.set_samples, transfer)
    publisher = ArtefactPublisher(job_lease, stores, transfer)
    if transfer:
        transfer.fetch_tetrahedra(settings.cache_dir / "tets")

    def on_progress(progress: Progress) -> None:
        reporter.report(progress.stage, progress.fraction, progress.message)

    result = build(
        inputs.source, inputs.filename, inputs.options, runner, on_progress, settings.cache_dir, publisher
    )
    model = runner.model.read_bytes() if runner.model else None
    publish_result(job_lease, stores, inputs, result, model)
    if transfer:
        transfer.delete_runs(runner.runs)


def publish_result(
    job_lease: JobLease, stores: Stores, inputs: BuildInputs, result: BuildResult, model: bytes | None
) -> None:
    """Store the files, then, in one transaction, reference them by the tree and set the job to done."""
    outputs = {"tables": result.table, "meshes": result.render_glb} | ({"models": model} if model else {})
    files: dict[str, str | None] = {"model_sha256": None}
    files |= {HASH_COLUMNS[kind]: stores.named(kind).put(data) for kind, data in outputs.items()}
    tree: dict[str, Any] = {
        **files,
        "preliminary": False,
        "report": result.report,
        "fingerprint": inputs.fingerprint,
        "updated_at": utc_now(),
    }
    done: dict[str, Any] = {"stage": "done", "fraction": 1.0}
    with job_lease.sessions.begin() as session:
        if end_job(session, job_lease.job_id, "done", message="Done", lease=job_lease.lease, **done):
            mark_replaced(session, session.get_one(Tree, inputs.tree_id), files)
            for kind, data in outputs.items():
                store_referenced(session, stores, kind, data)
            session.execute(update(Tree).where(Tree.id == inputs.tree_id).values(**tree))
