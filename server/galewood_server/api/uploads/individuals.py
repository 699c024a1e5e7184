"""Individuals of the built-in species: trees whose mesh the service makes itself, from some numbers."""

from __future__ import annotations

import hashlib

from fastapi import APIRouter, Response
from galewood.growth import GrowthError, find_generator
from galewood.options import IndividualRequest
from galewood.pipeline.individuals import IndividualDocument, document_of
from pydantic import BaseModel, ConfigDict, Field
from sqlalchemy.orm import Session

from galewood_server.access import check_quota, count_stored
from galewood_server.api.analyses.common import check_queue_length
from galewood_server.api.jobs import existing_build
from galewood_server.api.trees import find_tree, summary_out, tree_out
from galewood_server.api.uploads.upload import find_same, insert_tree
from galewood_server.context import Service, ServiceDep
from galewood_server.http import ProblemError, StorableText, TreeOut, TreeSummary, problems
from galewood_server.jobs import queue_job
from galewood_server.storage import Tree

router = APIRouter(prefix="/api/individuals", tags=["trees"])
USUAL_BYTES = 3_000_000
"""Size of the files of an individual: 1.3 to 2.4 MB of mesh with pictures, 0.3 MB of table."""
MOST_WAITING = 64
MOST_SOUGHT = 64


class IndividualOrder(IndividualRequest):
    """Body of POST /api/individuals."""

    species: StorableText = Field(
        min_length=1, max_length=64, description="A built-in species: oak, spruce, ..."
    )


class SoughtIndividuals(BaseModel):
    """Body of POST /api/individuals/find."""

    model_config = ConfigDict(extra="forbid")

    individuals: list[IndividualOrder] = Field(max_length=MOST_SOUGHT)


class FoundIndividuals(BaseModel):
    """Which individuals are here, and whether this server could grow the others."""

    trees: list[TreeSummary | None] = Field(
        description="Those asked for, in their order; null: it is not here, or not made yet."
    )
    cannot_grow: str | None = Field(description="Why this server grows no trees; null: it can.")


@router.post("/find", max_body_size=16_384, responses={**problems(413, 422)})
def find_individuals(body: SoughtIndividuals, service: ServiceDep) -> FoundIndividuals:
    """The individuals of these values that have been made here. Nothing is made, so it needs no key:
    whoever opens a link that names a forest's own trees finds those that others have asked for."""
    documents = [_document(order) for order in body.individuals]
    with service.sessions() as session:
        trees = [_made(service, session, document) for document in documents]
    try:
        find_generator()
    except GrowthError as error:
        return FoundIndividuals(trees=trees, cannot_grow=str(error))
    return FoundIndividuals(trees=trees, cannot_grow=None)


def _made(service: Service, session: Session, document: IndividualDocument) -> TreeSummary | None:
    """The tree of a document, if its mesh and table are there."""
    tree = find_same(session, _sha256(document), _options(document))
    return summary_out(tree) if tree and existing_build(service, tree, {}) else None


def _sha256(document: IndividualDocument) -> str:
    return hashlib.sha256(document.encoded()).hexdigest()


def _options(document: IndividualDocument) -> dict[str, str]:
    return {"species": document.species}


@router.post(
    "",
    status_code=202,
    max_body_size=4096,
    responses={
        200: {"model": TreeOut, "description": "Such a tree is there already."},
        **problems(413, 422, 429, 503, 507),
    },
)
def grow_individual(body: IndividualOrder, service: ServiceDep, response: Response) -> TreeOut:
    """Grow an individual of a built-in species: a mesh with branches of its own, and its motion within
    seconds (docs/species.md#individuals). It is a tree like an upload, made by a job (`job_id`) that can be
    followed and cancelled. The same values give the same tree, which is made once. A size that the species
    cannot have fails with a sentence; `nearest_size` avoids that. 503 `cannot-grow`: there is no Node."""
    try:
        find_generator()
    except GrowthError as error:
        raise ProblemError(503, "cannot-grow", "This server cannot grow trees", hint=str(error)) from error
    document = _document(body)
    with service.files_lock:
        tree, ready = _ordered(service, document)
    service.wake_supervisor()
    response.status_code = 200 if ready else 202
    response.headers["Location"] = f"/api/trees/{tree.id}"
    return tree


def _document(body: IndividualOrder) -> IndividualDocument:
    """The document of an individual. ProblemError 422 if there is no such species."""
    try:
        return document_of(body.species, IndividualRequest(**body.model_dump(exclude={"species"})))
    except KeyError as error:
        raise ProblemError(
            422,
            "unknown-species",
            f"There is no built-in tree of the species {body.species!r} in this form",
            hint="Choose the species of a built-in tree (GET /api/trees), in the form open or forest.",
        ) from error


def _ordered(service: Service, document: IndividualDocument) -> tuple[TreeOut, bool]:
    """The tree of a document, with a job that makes it unless it is there; and whether it is.

    ProblemError 429, 507.
    """
    name = _tree_of(service, document)
    with service.sessions.begin() as session:
        tree = find_tree(session, name)
        if tree.state == "building":
            return tree_out(tree), False
        if existing_build(service, tree, {}):
            return tree_out(tree), True
        _check_room(service, session)
        queue_job(session, tree, {}, "individual")
        count_stored(service.settings, USUAL_BYTES)
        return tree_out(tree), False


def _tree_of(service: Service, document: IndividualDocument) -> str:
    """The id of the tree of a document, which is added if it is missing."""
    source, options = document.encoded(), _options(document)
    with service.sessions() as session:
        found = find_same(session, _sha256(document), options)
        if found is None:
            _check_room(service, session)
        source_sha256 = service.stores.sources.put(source)
        if found is not None:
            return found.id
    request = document.request
    tree = Tree(
        name=document.name,
        species=document.species,
        form=request.form,
        grown=True,
        height_m=request.height_m,
        filename=f"{document.name}.glb",
        options=options,
        report={},
        source_sha256=source_sha256,
    )
    with service.sessions() as session:
        return insert_tree(session, tree)[0].id


def _check_room(service: Service, session: Session) -> None:
    """Raise ProblemError 429 if too many trees wait to be grown, 507 if the quota is reached."""
    check_queue_length(session, "individual", MOST_WAITING)
    check_quota(service.settings, USUAL_BYTES)
