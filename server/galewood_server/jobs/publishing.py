"""What a build hands out before it is done: pictures, the mesh to draw, and a first table to play."""

from __future__ import annotations

import logging
import threading

from galewood.table import TableError, read_metadata
from galewood.util import Cancelled
from sqlalchemy.orm import Session

from galewood_server.jobs.cluster.blob_transfer import BlobTransfer
from galewood_server.jobs.reporting import JobLease
from galewood_server.storage import Job, Stores, Tree, hold, mark_garbage, mark_replaced, utc_now

log = logging.getLogger("galewood.job")
PRELIMINARY, MESH, PICTURE, TETS = "preliminary.table", "render.glb", ".png", "tets-"


class Publisher:
    """Stores what `build_table` publishes and names it in the database; called from the build's threads."""

    def __init__(self, job_lease: JobLease, stores: Stores, transfer: BlobTransfer | None = None) -> None:
        self._job_lease = job_lease
        self._stores = stores
        self._transfer = transfer
        self._lock = threading.Lock()

    def __call__(self, name: str, content: bytes) -> None:
        """Take one thing in; what has no place here is passed over."""
        with self._lock:
            try:
                self._take(name, content)
            except Cancelled:  # the build is told by its next progress
                log.info("%s came after the end of job %s", name, self._job_lease.job_id)

    def _take(self, name: str, content: bytes) -> None:
        if name.endswith(PICTURE):
            self._show(name, content)
        elif name.startswith(TETS) and self._transfer:
            self._transfer.keep_tetrahedra(name, content)
        elif name == MESH:
            self._draw(content)
        elif name == PRELIMINARY:
            mesh_sha256 = str(read_metadata(content)["mesh_sha256"])
            if self._stores.meshes.has(mesh_sha256):
                self._play(content, mesh_sha256)

    def _show(self, name: str, picture: bytes) -> None:
        with self._job_lease.sessions.begin() as session:
            self._job_lease.check(session)
            sha256 = hold(session, self._stores, "pictures", picture)
            job = session.get_one(Job, self._job_lease.job_id)
            job.pictures = {**job.pictures, name: sha256}

    def _draw(self, mesh: bytes) -> None:
        """The mesh stands in the forest while its table is on the way; a moving one keeps its own."""
        mesh_sha256 = self._stores.meshes.put(mesh)
        with self._job_lease.sessions.begin() as session:
            tree = self._tree(session)
            if not tree.table_sha256 and tree.mesh_sha256 != mesh_sha256:
                hold(session, self._stores, "meshes", mesh)
                mark_garbage(session, "meshes", tree.mesh_sha256)
                tree.mesh_sha256, tree.updated_at = mesh_sha256, utc_now()

    def _play(self, table: bytes, mesh_sha256: str) -> None:
        """The early table takes the place of none, of another early one, or of one no reader knows."""
        table_sha256 = self._stores.tables.put(table)
        with self._job_lease.sessions.begin() as session:
            tree = self._tree(session)
            if tree.table_sha256 and not tree.preliminary and self._readable(tree.table_sha256):
                mark_garbage(session, "tables", table_sha256)
                return
            files = {"table_sha256": table_sha256, "mesh_sha256": mesh_sha256, "model_sha256": None}
            mark_replaced(session, tree, files)
            hold(session, self._stores, "tables", table)
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
