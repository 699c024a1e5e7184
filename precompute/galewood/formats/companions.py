"""The files that a mesh file refers to: textures, buffers, material libraries.

A reader asks for them by the name that the mesh file uses. A name never leads to a file of this computer:
only the contents of an uploaded archive can be found.
"""

from __future__ import annotations

import posixpath
from dataclasses import dataclass, field
from typing import Protocol
from urllib.parse import unquote

from galewood.util import shown_message

MOST_WARNINGS = 50


class Companions(Protocol):
    """Files beside a mesh, found by the name that the mesh uses for them."""

    def find(self, name: str) -> bytes | None:
        """The content of a file, or None if there is none of that name."""
        ...


class NoCompanions:
    """A mesh file that came alone."""

    def find(self, name: str) -> bytes | None:
        """None: there are no other files."""
        return None


@dataclass
class Source:
    """What a reader is given beside the bytes of the mesh; it adds warnings about whatever it drops."""

    files: Companions = field(default_factory=NoCompanions)
    warnings: list[str] = field(default_factory=list[str])

    def warn(self, text: str) -> None:
        """Add a warning once; it may quote the file."""
        message = shown_message(text)
        if message not in self.warnings and len(self.warnings) < MOST_WARNINGS:
            self.warnings.append(message)
            if len(self.warnings) == MOST_WARNINGS:
                self.warnings.append("There are more warnings of this kind than are listed.")


def local_name(name: str, folder: str = "") -> str | None:
    """A name as a path inside the archive, relative to its root; None for anything that leads out of it.

    Backslashes count as separators: some programs write them.
    """
    plain = unquote(name).replace("\\", "/").strip()
    if not plain or plain.startswith("/") or "\0" in plain or ":" in plain:
        return None
    path = posixpath.normpath(posixpath.join(folder, plain))
    return None if path.startswith("..") or path in (".", "") else path


def base_name(name: str) -> str:
    """The last component of a name in either notation, in lower case."""
    return unquote(name).replace("\\", "/").rsplit("/", 1)[-1].strip().lower()
