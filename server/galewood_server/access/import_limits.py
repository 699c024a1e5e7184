"""Mesh import in a sandboxed child process with the resource limits of the settings."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from galewood.options import ImportRequest

from galewood_server.settings import Settings

if TYPE_CHECKING:  # the mesh libraries are loaded with the first upload, not at startup
    from galewood.tree import TreeMesh

MeshImporter = Callable[[bytes, str, ImportRequest], tuple["TreeMesh", bytes]]
"""(file bytes, file name, options) -> (tree mesh, render mesh as GLB)."""


def limited_importer(settings: Settings) -> MeshImporter:
    """Return a function that imports an untrusted mesh. It raises MeshError for every kind of failure."""

    def read(data: bytes, filename: str, options: ImportRequest) -> tuple[TreeMesh, bytes]:
        from galewood.pipeline.tables import EXPECTED_MOTION
        from galewood.sandbox import Limits
        from galewood.tree import import_mesh_sandboxed

        limits = Limits(settings.import_memory_bytes, settings.import_cpu_s, settings.import_wall_s)
        return import_mesh_sandboxed(data, filename, options, limits, EXPECTED_MOTION)

    return read
