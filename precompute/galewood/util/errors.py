"""Errors that a user can resolve."""

from __future__ import annotations

from typing import Literal

from galewood.util.text import shown_message

Reason = Literal["malformed", "too-large", "unsupported", "unsuitable"]
"""Why a mesh is rejected.

"malformed": damaged bytes; "too-large": a limit is exceeded; "unsupported": not a supported format;
"unsuitable": a readable mesh that cannot be used as a tree.
"""


class MeshError(Exception):
    """A mesh that cannot be processed: ``title`` says what is wrong, ``hint`` what the user can do about it.

    ``code`` is a stable kebab-case identifier for programs; ``reason`` is the kind of problem. Both texts may
    quote the file: they are made fit to be shown.
    """

    def __init__(self, code: str, reason: Reason, title: str, hint: str = "") -> None:
        self.code = code
        self.reason: Reason = reason
        self.title = shown_message(title)
        self.hint = shown_message(hint)
        super().__init__(f"{self.title} {self.hint}".strip())
