"""Reading an upload in a child process with the limits of the settings."""

from __future__ import annotations

from collections.abc import Callable

from precompute.intake_types import IntakeOptions, TreeMesh
from server.settings import Settings

Intake = Callable[[bytes, str, IntakeOptions], tuple[TreeMesh, bytes]]


def limited_intake(settings: Settings) -> Intake:
    """A function that reads a mesh: the tree and its GLB, or an IntakeError whatever the mesh does to it."""

    def read(data: bytes, filename: str, options: IntakeOptions) -> tuple[TreeMesh, bytes]:
        from precompute.intake_process import run_intake  # mesh libraries: a start need not wait for them
        from precompute.limited_process import Limits

        limits = Limits(settings.intake_memory_bytes, settings.intake_cpu_s, settings.intake_wall_s)
        return run_intake(data, filename, options, limits)

    return read
