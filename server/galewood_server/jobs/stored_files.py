"""The stored files that a job reads: what is lost or damaged is named, with what to do about it."""

from __future__ import annotations

from pathlib import Path

from galewood_server.jobs.progress import JobFailedError
from galewood_server.storage import CONTENT_OF_STORE, DamagedFileError, Stores, Tree

RESTORE_HINT = "restore it from a backup (`galewood doctor` lists what is missing)"


def stored_bytes(stores: Stores, kind: str, sha256: str, filename: str = "") -> bytes:
    """The content of a stored file. JobFailedError if it is lost or damaged."""
    try:
        return stores.named(kind).get(sha256)
    except FileNotFoundError as error:
        raise _lost(kind, sha256, filename, "is lost") from error
    except DamagedFileError as error:
        raise _lost(kind, sha256, filename, "is damaged") from error


def mesh_source(stores: Stores, tree: Tree) -> bytes:
    """The mesh file of a tree: what was uploaded, or what is grown again. JobFailedError."""
    source = stored_bytes(stores, "sources", tree.source_sha256, tree.filename)
    if not tree.grown:
        return source
    from galewood.growth import GrowthError, grow_files  # loads what an upload has no use for
    from galewood.pipeline.individuals import read_document

    document = read_document(source)
    try:
        return grow_files(document.species, document.request).glb
    except GrowthError as error:
        raise JobFailedError(str(error)) from error


def stored_path(stores: Stores, kind: str, sha256: str) -> Path:
    """The path of a stored file. JobFailedError if it is lost."""
    try:
        path = stores.named(kind).path(sha256)
    except FileNotFoundError as error:
        raise _lost(kind, sha256, "", "is lost") from error
    if not path.is_file():
        raise _lost(kind, sha256, "", "is lost")
    return path


def _lost(kind: str, sha256: str, filename: str, how: str) -> JobFailedError:
    name = f" {filename}" if filename else ""
    owner, instead = (
        ("", "Upload it again") if kind == "sources" else (" of this tree", "Compute the tree again")
    )
    what = f"{CONTENT_OF_STORE[kind]}{owner}{name}"
    return JobFailedError(f"The {what} {how} ({kind}/{sha256[:12]}…). {instead}, or {RESTORE_HINT}.")
