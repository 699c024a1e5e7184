"""Reading an upload in a child process with the limits of the settings."""

from __future__ import annotations

from collections.abc import Callable

from galewood.mesh import IntakeOptions, TreeMesh

from galewood_server.settings import Settings

Intake = Callable[[bytes, str, IntakeOptions], tuple[TreeMesh, bytes]]


def limited_intake(settings: Settings) -> Intake:
    """A function that reads a mesh: the tree and its GLB, or an MeshError whatever the mesh does to it."""

    def read(data: bytes, filename: str, options: IntakeOptions) -> tuple[TreeMesh, bytes]:
        from galewood.mesh import run_intake
        from galewood.sandbox import Limits

        limits = Limits(settings.intake_memory_bytes, settings.intake_cpu_s, settings.intake_wall_s)
        return run_intake(data, filename, options, limits)

    return read
