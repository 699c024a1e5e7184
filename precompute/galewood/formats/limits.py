"""What one mesh may hold at most. All sizes that a file declares are checked before anything is allocated."""

from __future__ import annotations

from galewood.util import MeshError

MAX_BYTES = 256 * 1024 * 1024  # of a file, of all files that are read from an archive, of decoded data
MAX_FACES = 1_500_000  # in the file, with its ground and other objects
MAX_VERTICES = 3 * MAX_FACES
MAX_PIXELS = 64_000_000  # of one image


def too_many_faces(count: int) -> MeshError:
    """The error for a mesh with more than MAX_FACES triangles."""
    return MeshError(
        "too-many-faces",
        "too-large",
        f"The mesh has {count} triangles, more than the limit of {MAX_FACES}.",
        "Decimate the mesh and export it again.",
    )


def check_faces(count: int) -> None:
    """Raises MeshError for more than MAX_FACES triangles."""
    if count > MAX_FACES:
        raise too_many_faces(count)


class Budget:
    """Triangles, vertices and decoded bytes that a file has used so far; MeshError beyond the limits."""

    def __init__(self) -> None:
        self._faces = 0
        self._vertices = 0
        self._bytes = 0

    def add_faces(self, count: int) -> None:
        """Take `count` triangles."""
        self._faces += count
        check_faces(self._faces)

    def add_vertices(self, count: int) -> None:
        """Take `count` vertices."""
        self._vertices += count
        if self._vertices > MAX_VERTICES:
            raise MeshError(
                "too-many-vertices",
                "too-large",
                f"The mesh has more than {MAX_VERTICES} vertices.",
                "Remove unused vertices, decimate the mesh and export it again.",
            )

    def add_bytes(self, count: int) -> None:
        """Take `count` bytes of decoded data."""
        self._bytes += count
        if self._bytes > MAX_BYTES:
            raise MeshError(
                "decoded-too-large",
                "too-large",
                f"The compressed data expand to more than {MAX_BYTES >> 20} MB.",
                "Decimate the mesh and export it again.",
            )
