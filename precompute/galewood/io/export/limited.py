"""An export in a child process with limits, for services: the mesh came from somebody else."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from galewood.io.export.bundle import ExportOptions, archive, options_of, write_export
from galewood.io.export.errors import ExportError
from galewood.motion.wind import WindError
from galewood.sandbox import Arrays, Limits, run_limited
from galewood.table import TableError, decode
from galewood.util import MeshError

LIMITS = Limits(memory_bytes=6 << 30, cpu_s=180)


def export_limited(
    table: bytes, glb: bytes, kind: str, name: str, options: ExportOptions, compliance: bytes | None = None
) -> bytes:
    """The files of an export as a ZIP archive, made in a child process. Raises MeshError."""
    request = {"kind": kind, "name": name, "options": json.dumps(options.document())}
    arguments = {
        "table": np.frombuffer(table, np.uint8),
        "glb": np.frombuffer(glb, np.uint8),
        "compliance": np.frombuffer(compliance or b"", np.uint8),
        "request": np.frombuffer(json.dumps(request).encode(), np.uint8),
    }
    found = run_limited(
        "galewood.io.export.limited:export_in_child", arguments, LIMITS, what="Exporting the tree"
    )
    return found["archive"].tobytes()


def export_in_child(arguments: Arrays) -> Arrays:
    """Entry point of the child process of ``export_limited``."""
    request = json.loads(arguments["request"].tobytes())
    folder = Path("export")
    try:
        table = decode(arguments["table"].tobytes())
        options = options_of(request["options"])
        glb, compliance = arguments["glb"].tobytes(), arguments["compliance"].tobytes() or None
        write_export(table, glb, request["kind"], folder, request["name"], options, compliance=compliance)
    except (ExportError, TableError, WindError) as error:
        raise MeshError("export-failed", "unsuitable", "The tree cannot be exported", str(error)) from error
    return {"archive": np.frombuffer(archive(folder), np.uint8)}
