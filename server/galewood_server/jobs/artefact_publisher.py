"""Artefacts that a running build publishes: preview images, the render mesh and the preliminary table."""

from __future__ import annotations

import logging
import threading

from galewood.table import TableError, read_metadata
from galewood.util import Cancelled
from sqlalchemy.orm import Session

from galewood_server.jobs.cluster.blob_transfer import BlobTransfer
from galewood_server.jobs.progress import JobLease
from galewood_server.storage import Job, Stores, Tree, mark_garbage, mark_replaced, store_referenced, utc_now

log = logging.getLogger("galewood.job")
PRELIMINARY, MESH, PICTURE, TETS = "preliminary.table", "render.glb", ".png", "tets-"


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
        if name.endswith(PICTURE):
            self._publish_picture(name, content)
        elif name.startswith(TETS) and self._transfer:
            self._transfer.store_tetrahedra(name, content)
        elif name == MESH:
            self._publish_mesh(content)
        elif name == PRELIMINARY:
            mesh_sha256 = str(read_metadata(content)["mesh_sha256"])
            if self._stores.meshes.has(mesh_sha256):
                self._publish_preliminary_table(content, mesh_sha256)

    def _publish_picture(self, name: str, picture: bytes) -> None:
        with self._job_lease.sessions.begin() as session:
            self._job_lease.check(session)
            sha256 = store_referenced(session, self._stores, "pictures", picture)
            job = session.get_one(Job, self._job_lease.job_id)
            job.pictures = {**job.pictures, name: sha256}

    def _publish_mesh(self, mesh: bytes) -> None:
        """Set the mesh of a tree without a table; a tree with a table keeps the mesh of that table."""
        mesh_sha256 = self._stores.meshes.put(mesh)
        with self._job_lease.sessions.begin() as session:
            tree = self._tree(session)
            if not tree.table_sha256 and tree.mesh_sha256 != mesh_sha256:
                store_referenced(session, self._stores, "meshes", mesh)
                mark_garbage(session, "meshes", tree.mesh_sha256)
                tree.mesh_sha256, tree.updated_at = mesh_sha256, utc_now()

    def _publish_preliminary_table(self, table: bytes, mesh_sha256: str) -> None:
        """Set the preliminary table unless the tree has a complete, readable table."""
        table_sha256 = self._stores.tables.put(table)
        with self._job_lease.sessions.begin() as session:
            tree = self._tree(session)
            if tree.table_sha256 and not tree.preliminary and self._readable(tree.table_sha256):
                mark_garbage(session, "tables", table_sha256)
                return
            files = {"table_sha256": table_sha256, "mesh_sha256": mesh_sha256, "model_sha256": None}
            mark_replaced(session, tree, files)
            store_referenced(session, self._stores, "tables", table)
            tree.table_sha256, tree.mesh_sha256 = table_sha256, mesh_sha256
            tree.preliminary, tree.model_sha256, tree.updated_at = True, None, utc_now()

    def _tree(self, session: Session) -> Tree:
        self._job_lease.check(session)
        return session.get_one(Job, self._job_lease.job_id).tree

    def _readable(self, sha256: str) -> bool:
        try:
            read_metadata(self._stores.tables.get(sha256))
        except (TableError, OSError):
            return False
        return True
