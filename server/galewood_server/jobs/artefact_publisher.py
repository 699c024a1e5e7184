"""Artefacts that a running build publishes: preview images, the render mesh and preliminary tables."""

from __future__ import annotations

import logging
import threading

from galewood.pipeline.results import PICTURE_SUFFIX
from galewood.pipeline.stages import RENDER_MESH_FILE, TETS_PREFIX
from galewood.pipeline.tables import TableStage
from galewood.table import TableError, read_metadata
from galewood.util import Cancelled
from sqlalchemy.orm import Session

from galewood_server.jobs.cluster.blob_transfer import BlobTransfer
from galewood_server.jobs.progress import JobLease
from galewood_server.storage import (
    Job,
    Stores,
    Tree,
    mark_garbage,
    no_table,
    replace_files,
    store_referenced,
    utc_now,
)

log = logging.getLogger("galewood.job")


class ArtefactPublisher:
    """Stores the artefacts of `build_table` and references them in the database. Thread-safe."""

    def __init__(self, job_lease: JobLease, stores: Stores, transfer: BlobTransfer | None = None) -> None:
        self._job_lease = job_lease
        self._stores = stores
        self._transfer = transfer
        self._lock = threading.Lock()

    def __call__(self, name: str, content: bytes) -> None:
        """Store an artefact; unknown names are ignored."""
        with self._lock:
            try:
                self._publish(name, content)
            except Cancelled:  # raised again by the build's next progress report
                log.info("ignored %s, published after the end of job %s", name, self._job_lease.job_id)

    def _publish(self, name: str, content: bytes) -> None:
        if name.endswith(PICTURE_SUFFIX):
            self._publish_picture(name, content)
        elif name.startswith(TETS_PREFIX):
            self._publish_tetrahedra(name, content)
        elif name == RENDER_MESH_FILE:
            self._publish_mesh(content)
        elif name == TableStage.BEAMS.file:
            self._publish_first_table(content)

    def _publish_picture(self, name: str, picture: bytes) -> None:
        with self._job_lease.sessions.begin() as session:
            self._job_lease.check(session)
            sha256 = store_referenced(session, self._stores, "pictures", picture)
            job = session.get_one(Job, self._job_lease.job_id)
            job.pictures = {**job.pictures, name: sha256}

    def _publish_tetrahedra(self, name: str, content: bytes) -> None:
        """Tell which file of the cache holds the tetrahedra; servers that take over the job need a copy."""
        if self._transfer:
            self._transfer.store_tetrahedra(name, content)
        with self._job_lease.sessions.begin() as session:
            self._job_lease.check(session)
            session.get_one(Job, self._job_lease.job_id).result = {"tetrahedra": name}

    def _publish_mesh(self, mesh: bytes) -> None:
        """Set the mesh of a tree without a table; a tree with a table keeps the mesh of that table."""
        mesh_sha256 = self._stores.meshes.put(mesh)
        with self._job_lease.sessions.begin() as session:
            tree = self._tree(session)
            if not tree.table_sha256 and tree.mesh_sha256 != mesh_sha256:
                store_referenced(session, self._stores, "meshes", mesh)
                mark_garbage(session, "meshes", tree.mesh_sha256)
                tree.mesh_sha256, tree.updated_at = mesh_sha256, utc_now()

    def _publish_first_table(self, table: bytes) -> None:
        """Set the first table, unless the tree has one that clients can read."""
        mesh_sha256 = str(read_metadata(table)["mesh_sha256"])
        if not self._stores.meshes.has(mesh_sha256):
            return
        files = no_table() | {"table_sha256": self._stores.tables.put(table), "mesh_sha256": mesh_sha256}
        with self._job_lease.sessions.begin() as session:
            tree = self._tree(session)
            if self._is_readable(tree.table_sha256):
                mark_garbage(session, "tables", files["table_sha256"])
                return
            replace_files(session, tree, files)
            store_referenced(session, self._stores, "tables", table)
            tree.preliminary, tree.updated_at = True, utc_now()

    def _tree(self, session: Session) -> Tree:
        self._job_lease.check(session)
        return session.get_one(Job, self._job_lease.job_id).tree

    def _is_readable(self, table_sha256: str | None) -> bool:
        """Whether there is a table of this hash that clients can read."""
        if table_sha256 is None:
            return False
        try:
            read_metadata(self._stores.tables.get(table_sha256))
        except (TableError, OSError):
            return False
        return True
