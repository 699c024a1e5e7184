"""Built-in trees whose tables are distributed with the software."""

from __future__ import annotations

from galewood.pipeline.results import ShippedTree
from sqlalchemy.orm import Session

from galewood_server.context import Service
from galewood_server.jobs import request_cancel
from galewood_server.storage import (
    ACTIVE_STATES,
    FILE_COLUMNS,
    Job,
    Tree,
    files_of,
    no_table,
    replace_files,
    store_referenced,
    utc_now,
)

SHIPPED_MESSAGE = "Shipped with the software"


def install(session: Session, service: Service, tree: Tree, shipped: ShippedTree, fingerprint: str) -> None:
    """Store the files of a shipped tree as if they had just been computed; an active build is cancelled.

    Its model is not distributed: the first analysis that needs it computes it from the tetrahedra.
    """
    shipped.keep_tetrahedra(service.settings.cache_dir)
    if tree.job and tree.job.state in ACTIVE_STATES:
        request_cancel(session, tree.job.id)
    hashes = {
        field: store_referenced(session, service.stores, FILE_COLUMNS[field], data)
        for field, data in files_of(shipped.result).items()
    }
    replace_files(session, tree, {**no_table(), **hashes})
    tree.preliminary, tree.report = False, shipped.result.report
    tree.fingerprint, tree.updated_at = fingerprint, utc_now()
    pictures = {
        name: store_referenced(session, service.stores, "pictures", picture)
        for name, picture in shipped.pictures.items()
    }
    # pictures belong to a job, which also tells when and how the table was made
    job = Job(
        tree_id=tree.id, state="done", stage="done", fraction=1.0, message=SHIPPED_MESSAGE, pictures=pictures
    )
    job.result = {"tetrahedra": shipped.tets_name}
    tree.jobs.append(job)
