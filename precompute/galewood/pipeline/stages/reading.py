"""Reads an upload once: a sandboxed child makes its tree for the build, and the table that moves it at once.

The caller stores the tree; a build, also one of another server or after a restart, goes on from there unless
the file, its options or the importer have changed.
"""

from __future__ import annotations

import hashlib
import io
import json
import logging
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from galewood.options import ImportRequest
from galewood.sandbox import Arrays, from_json_array, to_bytes_array, to_json_array
from galewood.versions import sources_hash

if TYPE_CHECKING:  # the caller needs no mesh libraries, only the child does
    from galewood.tree import TreeMesh

log = logging.getLogger("galewood.import")
READ_IN_CHILD = "galewood.pipeline.stages.reading:read_in_child"
"""The function to run in a sandboxed child."""
KEY_ARRAY, GLB_ARRAY, BEAMS_ARRAY, HEAD_ARRAY = "key", "glb", "beams", "head"
"""Names of arrays beside those of the tree; the last one is among these."""


@dataclass(frozen=True)
class ReadUpload:
    """What a mesh file was read as."""

    species: str | None
    height_m: float
    report: dict[str, Any]
    render_glb: bytes
    tree: bytes
    """The tree for a build: a file that ``kept_tree`` reads."""
    beams: bytes | None
    """The table of beams along its branches; None: not asked for, cannot be made, or tears the tree."""


def read_upload(
    run: Callable[[Arrays], Arrays],
    data: bytes,
    filename: str,
    options: ImportRequest,
    *,
    moving: bool,
) -> ReadUpload:
    """Read a mesh file. ``run`` calls READ_IN_CHILD in a sandboxed child. Raises MeshError.

    ``moving``: whether the table of beams is wanted.
    """
    request = {"filename": filename, "options": _as_json(options), "moving": moving}
    result = run({"data": to_bytes_array(data), "request": to_json_array(request)})
    render_glb, beams = result.pop(GLB_ARRAY).tobytes(), result.pop(BEAMS_ARRAY, None)
    head = from_json_array(result[HEAD_ARRAY])
    key = import_key(hashlib.sha256(data).hexdigest(), filename, options)
    tree = io.BytesIO()
    np.savez(tree, allow_pickle=False, **{**result, KEY_ARRAY: to_json_array(key)})
    return ReadUpload(
        head["species"],
        head["height_m"],
        head["report"],
        render_glb,
        tree.getvalue(),
        None if beams is None else beams.tobytes(),
    )


def import_key(source_sha256: str, filename: str, options: ImportRequest) -> str:
    """Hash of everything that decides what a mesh file is read as."""
    parts = [source_sha256, filename, _as_json(options), sources_hash()]
    return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()


def kept_tree(tree: bytes, key: str) -> TreeMesh | None:
    """The tree of a file that ``read_upload`` made; None if it has another ``import_key``."""
    with np.load(io.BytesIO(tree), allow_pickle=False) as file:
        if from_json_array(file[KEY_ARRAY]) != key:
            return None
        from galewood.tree import unpack_tree  # loads the mesh libraries

        return unpack_tree({name: file[name] for name in file.files})


def _as_json(options: ImportRequest) -> dict[str, Any]:
    """The options of the import, also of a request that has further ones."""
    return options.model_dump(mode="json", include=set(ImportRequest.model_fields), exclude_none=True)


def read_in_child(arguments: Arrays) -> Arrays:
    """The part of ``read_upload`` that runs in the child."""
    from galewood.pipeline.tables import with_expected_motion
    from galewood.tree import pack_tree, read_tree, render_glb

    request = from_json_array(arguments["request"])
    options = ImportRequest.model_validate(request["options"])
    tree = read_tree(arguments["data"].tobytes(), request["filename"], options)
    glb = render_glb(tree)
    beams = _beams(tree, options, glb) if request["moving"] else None
    return {
        **pack_tree(with_expected_motion(tree)),
        GLB_ARRAY: to_bytes_array(glb),
        **({} if beams is None else {BEAMS_ARRAY: to_bytes_array(beams)}),
    }


def _beams(tree: TreeMesh, options: ImportRequest, render_glb: bytes) -> bytes | None:
    """The first table of a build with these options; None if it tears the tree or cannot be made.

    Neither fails an upload.
    """
    from galewood.pipeline.tables import BuildOptions, beam_table, encoded_unless_torn

    try:
        table = beam_table(tree, BuildOptions.model_validate(_as_json(options)), render_glb)
        return encoded_unless_torn(table)
    except Exception:
        log.exception("no table of beams")
        return None


def warm_up() -> None:
    """Load all that ``read_in_child`` needs, the compiled kernels too, by reading a small tree."""
    from galewood.pipeline.stages.kernel_compilation import small_tree_obj

    request = {"filename": "small-tree.obj", "options": {}, "moving": True}
    read_in_child({"data": to_bytes_array(small_tree_obj()), "request": to_json_array(request)})
