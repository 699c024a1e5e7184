"""A job that computes the table of a tree and publishes it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from galewood.options import BuildRequest
from galewood.pipeline import BuildOptions, BuildResult, Progress, build_options
from sqlalchemy import update

from galewood_server.jobs.cluster.blob_transfer import BlobTransfer
from galewood_server.jobs.cluster.dask_runner import DaskRunner
from galewood_server.jobs.publishing import Publisher
from galewood_server.jobs.queue import end_job
from galewood_server.jobs.reporting import JobLease, Reporter
from galewood_server.jobs.table_fingerprint import fingerprint
from galewood_server.settings import Settings
from galewood_server.storage import FIELDS, Job, Sessions, Stores, Tree, hold, mark_replaced, utc_now

Build = Callable[..., BuildResult]


@dataclass(frozen=True)
class Order:
    """What is to be built, as it was when the job began."""

    tree_id: str
    source: bytes
    filename: str
    options: BuildOptions
    fingerprint: str


def read_order(sessions: Sessions, stores: Stores, job_id: str) -> Order:
    """The order of a job: its tree's mesh and options, overruled by the job's own settings."""
    with sessions() as session:
        job = session.get_one(Job, job_id)
        tree = job.tree
        return Order(
            tree_id=tree.id,
            source=stores.sources.get(tree.source_sha256),
            filename=tree.filename,
            options=build_options(BuildRequest.model_validate({**tree.options, **job.settings})),
            fingerprint=fingerprint(tree.source_sha256, tree.options, job.settings),
        )


def run_build(job_lease: JobLease, address: str, settings: Settings, stores: Stores, build: Build) -> None:
    """Compute and publish. Raises MeshError, EngineLostError, Cancelled."""
    order = read_order(job_lease.sessions, stores, job_lease.job_id)
    reporter = Reporter(job_lease)
    transfer = BlobTransfer(settings.store_url, job_lease.job_id) if settings.store_url else None
    runner = DaskRunner(address, settings.cancel_flag(job_lease.job_id), reporter.samples, transfer)
    publish = Publisher(job_lease, stores, transfer)
    if transfer:
        transfer.bring_tetrahedra(settings.cache_dir / "tets")

    def progress(now: Progress) -> None:
        reporter.report(now.stage, now.fraction, now.message)

    result = build(order.source, order.filename, order.options, runner, progress, settings.cache_dir, publish)
    model = runner.model.read_bytes() if runner.model else None
    publish_result(job_lease, stores, order, result, model)
    if transfer:
        transfer.forget(runner.runs)


def publish_result(
    job_lease: JobLease, stores: Stores, order: Order, result: BuildResult, model: bytes | None
) -> None:
    """The files first, then, in one transaction, the tree that names them and the job's end."""
    made = {"tables": result.table, "meshes": result.render_glb} | ({"models": model} if model else {})
    files: dict[str, str | None] = {"model_sha256": None}
    files |= {FIELDS[kind]: stores.named(kind).put(data) for kind, data in made.items()}
    tree: dict[str, Any] = {
        **files,
        "preliminary": False,
        "report": result.report,
        "fingerprint": order.fingerprint,
        "updated_at": utc_now(),
    }
    done: dict[str, Any] = {"stage": "done", "fraction": 1.0}
    with job_lease.sessions.begin() as session:
        if end_job(session, job_lease.job_id, "done", message="Done", lease=job_lease.lease, **done):
            mark_replaced(session, session.get_one(Tree, order.tree_id), files)
            for kind, data in made.items():
                hold(session, stores, kind, data)
            session.execute(update(Tree).where(Tree.id == order.tree_id).values(**tree))
