"""The job of an individual: grows it, and stores its mesh and the table of its quick motion."""

from __future__ import annotations

import hashlib

from galewood.growth import GrowthError
from galewood.pipeline.individuals import IndividualDocument, individual_result, read_document
from galewood.pipeline.results import LIGHT_FOLDER, light_like
from galewood.pipeline.stages import Stage
from galewood.table import read_metadata
from galewood.util import write_atomically

from galewood_server.jobs.build_job import BuiltTree, publish_result
from galewood_server.jobs.progress import JobFailedError, JobLease
from galewood_server.jobs.stored_files import stored_bytes
from galewood_server.jobs.table_fingerprint import fingerprint
from galewood_server.settings import Settings
from galewood_server.storage import Job, Stores


def run_individual(job_lease: JobLease, settings: Settings, stores: Stores) -> None:
    """Grow an individual from its document. Raises JobFailedError, Cancelled; ValueError if it is damaged."""
    with job_lease.sessions() as session:
        job = session.get_one(Job, job_lease.job_id)
        tree = job.tree
        source = stored_bytes(stores, "sources", tree.source_sha256, tree.filename)
        built = BuiltTree(tree.id, fingerprint(tree.source_sha256, tree.options, job.settings))

    def on_stage(fraction: float, message: str) -> None:
        job_lease.write(stage=Stage.IMPORT.value, fraction=fraction, message=message)

    document = read_document(source)
    try:
        result = individual_result(document, on_stage)
    except GrowthError as error:
        raise JobFailedError(str(error)) from error
    with job_lease.sessions.begin() as session:
        job_lease.check(session)
        session.get_one(Job, job_lease.job_id).tree.height_m = read_metadata(result.table)["height_m"]
    _keep_light_copy(settings, document, result.render_glb)
    publish_result(job_lease, stores, built, result, None)


def _keep_light_copy(settings: Settings, document: IndividualDocument, render_glb: bytes) -> None:
    """Keep a light copy of the mesh, which refers to the pictures of its built-in tree, for browsers."""
    form = document.request.form
    builtin = document.species if form == "open" else f"{document.species}-{form}"
    light = light_like(render_glb, settings.species_dir / LIGHT_FOLDER, builtin)
    if light is not None:
        write_atomically(settings.light_copy(hashlib.sha256(render_glb).hexdigest()), light)
