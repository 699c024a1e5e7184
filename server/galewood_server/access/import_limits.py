"""Reading an upload in a child process with the limits of the settings."""

from __future__ import annotations

from collections.abc import Callable

from galewood.mesh import ImportOptions, TreeMesh

from galewood_server.settings import Settings

MeshImporter = Callable[[bytes, str, ImportOptions], tuple[TreeMesh, bytes]]


def limited_importer(settings: Settings) -> MeshImporter:
    """A function that reads a mesh: the tree and its GLB, or an MeshError whatever the mesh does to it."""

    def read(data: bytes, filename: str, options: ImportOptions) -> tuple[TreeMesh, bytes]:
        from galewood.mesh import import_mesh_sandboxed
        from galewood.sandbox import Limits

        limits = Limits(settings.import_memory_bytes, settings.import_cpu_s, settings.import_wall_s)
        return import_mesh_sandboxed(data, filename, options, limits)

    return read
