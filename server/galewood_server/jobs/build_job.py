"""Build job: computes the table of a tree and its records, and stores them."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any
from zipfile import BadZipFile

from galewood.constants import RECORDS_STAGE, STAGES_AFTER_TABLE
from galewood.pipeline.results import BuildResult
from galewood.pipeline.stages import ImportedTree, Progress, Stage, import_key, kept_tree
from galewood.pipeline.tables import BuildOptions
from galewood.util import kernels_compiled
from sqlalchemy.orm import Session

from galewood_server.jobs.analyses.model_job import usual_options
from galewood_server.jobs.artefact_publisher import ArtefactPublisher
from galewood_server.jobs.cluster.blob_transfer import BlobTransfer
from galewood_server.jobs.cluster.dask_runner import DaskRunner
from galewood_server.jobs.processes import lower_priority
from galewood_server.jobs.progress import JobLease, ProgressReporter
from galewood_server.jobs.queue import end_job
from galewood_server.jobs.stored_files import mesh_source
from galewood_server.jobs.table_fingerprint import fingerprint
from galewood_server.settings import Settings
from galewood_server.storage import (
    FILE_COLUMNS,
    FOLLOWING_COLUMNS,
    IMPORT_COLUMNS,
    Job,
    Sessions,
    Stores,
    Tree,
    files_of,
    no_table,
    replace_files,
    store_referenced,
    utc_now,
)

log = logging.getLogger("galewood.job")
Build = Callable[..., BuildResult]
YIELD_S = 0.5
"""Time between two looks for trees that wait for their tables, s."""
RECORDS_PRIORITY = -10
"""Priority of the simulations of that stage on the cluster; those of other builds have 0."""


@dataclass(frozen=True)
class BuiltTree:
    """The tree that a job makes a table of, and the fingerprint of that table."""

    tree_id: str
    fingerprint: str


@dataclass(frozen=True)
class BuildInputs(BuiltTree):
    """The inputs of a build, read when the job starts."""

    source: bytes | ImportedTree
    """The file, or what an import of it has left."""
    filename: str
    options: BuildOptions


def read_build_inputs(sessions: Sessions, stores: Stores, job_id: str) -> BuildInputs:
    """The inputs of a job: its tree's mesh and options, overridden by the job's settings.

    JobFailedError if the mesh is lost.
    """
    with sessions() as session:
        job = session.get_one(Job, job_id)
        tree = job.tree
        options = BuildOptions.model_validate({**usual_options(tree), **tree.options, **job.settings})
        source = imported_tree(stores, tree, options)
        return BuildInputs(
            tree_id=tree.id,
            source=source or mesh_source(stores, tree),
            filename=tree.filename,
            options=options,
            fingerprint=fingerprint(tree.source_sha256, tree.options, job.settings),
        )


def imported_tree(stores: Stores, tree: Tree, options: BuildOptions) -> ImportedTree | None:
    """What the import of a tree has left; None if it is lost, or was made with other options or by another
    version: the file is then read again.
    """
    if not tree.import_sha256 or not tree.mesh_sha256:
        return None
    key = import_key(tree.source_sha256, tree.filename, options)
    try:
        found = kept_tree(stores.imports.get(tree.import_sha256), key)
        render_glb = stores.meshes.get(tree.mesh_sha256)
    except (OSError, EOFError, ValueError, KeyError, BadZipFile) as error:
        log.warning("reading %s again: %s", tree.filename, error)
        return None
    return ImportedTree(found, render_glb, moving=tree.table_sha256 is not None) if found else None


class RunningBuild:
    """A build: what it reports, publishes and stores on its way."""

    def __init__(
        self, job_lease: JobLease, address: Callable[[], str], settings: Settings, stores: Stores
    ) -> None:
        self._job_lease = job_lease
        self._settings = settings
        self._stores = stores
        self._inputs = read_build_inputs(job_lease.sessions, stores, job_lease.job_id)
        self._reporter = ProgressReporter(job_lease)
        self._transfer = BlobTransfer(settings.store_url, job_lease.job_id) if settings.store_url else None
        flag = settings.cancel_flag(job_lease.job_id)
        self._loading: threading.Thread | None = None
        self._runner = DaskRunner(address, flag, self._reporter.set_samples, self._transfer)
        self._model: bytes | None = None
        self._yielded_s = time.monotonic()
        self._after_table = False
        if job_lease.reached().part:
            self._make_way()

    def run(self, build: Build) -> None:
        """Compute and store the table and its records."""
        if self._settings.prepare and not kernels_compiled():
            self._compile_kernels()
        if self._transfer:
            self._transfer.fetch_tetrahedra(self._settings.cache_dir / "tets")
        result = build(
            self._inputs.source,
            self._inputs.filename,
            self._inputs.options,
            self._runner,
            self._on_progress,
            self._settings.cache_dir,
            ArtefactPublisher(self._job_lease, self._stores, self._transfer),
            self._on_table,
        )
        publish_result(self._job_lease, self._stores, self._inputs, result, self._model)
        if self._transfer:
            self._transfer.delete_runs(self._runner.runs)

    def _compile_kernels(self) -> None:
        from galewood.pipeline.stages import compile_kernels

        self._reporter.report(Stage.IMPORT.value, 0.0, "Compiling the numeric kernels (once on this machine)")
        compile_kernels()

    def _on_progress(self, progress: Progress) -> None:
        if self._loading is None:
            self._loading = threading.Thread(target=load_early, name="load-early", daemon=True)
            self._loading.start()
        self._reporter.report(progress.stage.value, progress.fraction, progress.message)
        if self._after_table and time.monotonic() - self._yielded_s > YIELD_S:
            self._yielded_s = time.monotonic()
            self._job_lease.yield_to_others()

    def _make_way(self) -> None:
        """What follows a table is less urgent than all else, and waits for the tables of other trees."""
        if not self._after_table:
            self._after_table, self._yielded_s = True, -YIELD_S
            self._runner.priority = RECORDS_PRIORITY
            lower_priority()

    def _on_table(self, result: BuildResult) -> None:
        """Store the complete table; what follows, the paper's records and the bare table, is less urgent.

        Called again with the records if a bare table follows, whose model is another one.
        """
        if self._model is None and self._runner.model:
            self._model = self._runner.model.read_bytes()
        publish_table(self._job_lease, self._stores, self._inputs, result, self._model)
        self._make_way()


def load_early() -> None:
    """Load what the training runs need while this process waits for the mesher."""
    import distributed  # noqa: F401  # pyright: ignore[reportUnusedImport]


def run_build(
    job_lease: JobLease, address: Callable[[], str], settings: Settings, stores: Stores, build: Build
) -> None:
    """Compute and store a table and its records. Raises MeshError, EngineLostError, Cancelled.

    `address` is called when the first training runs are to be simulated; it waits for the cluster.
    """
    RunningBuild(job_lease, address, settings, stores).run(build)


def publish_table(
    job_lease: JobLease, stores: Stores, inputs: BuiltTree, result: BuildResult, model: bytes | None
) -> None:
    """Store the complete table of a running build: its tree is ready, while the job continues.

    Raises Cancelled.
    """
    files = _put(stores, result, model)
    with job_lease.sessions.begin() as session:
        job_lease.check(session)
        _set_table(session, stores, inputs, files, result)
        job = session.get_one(Job, job_lease.job_id)
        if job.stage not in STAGES_AFTER_TABLE:  # a resumed job may have come farther
            job.stage, job.fraction = RECORDS_STAGE, 0.0
        job.seconds_left = None


def publish_result(
    job_lease: JobLease, stores: Stores, inputs: BuiltTree, result: BuildResult, model: bytes | None
) -> None:
    """Store the files, then, in one transaction, reference them by the tree and set the job to done."""
    files = _put(stores, result, model)
    done: dict[str, Any] = {"stage": Stage.DONE.value, "fraction": 1.0}
    with job_lease.sessions.begin() as session:
        if end_job(session, job_lease.job_id, "done", message="Done", lease=job_lease.lease, **done):
            tree = _set_table(session, stores, inputs, files, result)
            replace_files(session, tree, dict.fromkeys(IMPORT_COLUMNS))


def _put(stores: Stores, result: BuildResult, model: bytes | None) -> dict[str, bytes]:
    """Store the files of a result, to keep the transaction short that references them: column -> content."""
    files = files_of(result, model)
    for field, data in files.items():
        stores.named(FILE_COLUMNS[field]).put(data)
    return files


def _set_table(
    session: Session, stores: Stores, inputs: BuiltTree, files: Mapping[str, bytes], result: BuildResult
) -> Tree:
    """Reference the files of a result by its tree, which keeps what belongs to an unchanged table."""
    tree = session.get_one(Tree, inputs.tree_id)
    hashes = {
        field: store_referenced(session, stores, FILE_COLUMNS[field], data) for field, data in files.items()
    }
    unchanged = tree.table_sha256 == hashes["table_sha256"]
    kept = {field: getattr(tree, field) for field in FOLLOWING_COLUMNS if unchanged}
    replace_files(session, tree, {**no_table(), **kept, **hashes})
    tree.preliminary, tree.report = False, result.report
    tree.fingerprint, tree.updated_at = inputs.fingerprint, utc_now()
    return tree
