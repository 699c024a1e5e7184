"""Mesh import in a sandboxed child process with the resource limits of the settings."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from galewood.options import ImportRequest
from galewood.util import kernels_compiled

from galewood_server.settings import Settings

if TYPE_CHECKING:  # the sandbox is loaded when the service starts, not with the application
    from galewood.pipeline.stages import ReadUpload


MeshImporter = Callable[[bytes, str, ImportRequest], "ReadUpload"]
"""(file bytes, file name, options) -> what was read."""


class LimitedImporter:
    """Reads untrusted meshes in a sandboxed child. It raises MeshError for every kind of failure."""

    def __init__(self, settings: Settings) -> None:
        from galewood.pipeline.stages import READ_IN_CHILD
        from galewood.sandbox import Limits, PreparedFunction

        self._limits = Limits(settings.import_memory_bytes, settings.import_cpu_s, settings.import_wall_s)
        self._function = PreparedFunction(READ_IN_CHILD)

    def prepare(self) -> None:
        """Load what an import takes, so that no upload waits for it; not without the compiled kernels."""
        if kernels_compiled():
            self._function.prepare()

    def __call__(self, data: bytes, filename: str, options: ImportRequest) -> ReadUpload:
        """Read a mesh file, and make its first table; without compiled kernels the build makes it."""
        from galewood.pipeline.stages import read_upload

        run = partial(self._function.run, limits=self._limits, what="Reading the mesh")
        return read_upload(run, data, filename, options, moving=kernels_compiled())

    def close(self) -> None:
        """Let go of what `prepare` has loaded."""
        self._function.close()
