"""Errors that a user can act on."""

from __future__ import annotations

from typing import Literal

Reason = Literal["malformed", "too-large", "unsupported", "unsuitable"]
"""Damaged bytes; more than the limits allow; a format that is not read; a readable mesh that is no tree."""


class MeshError(Exception):
    """A mesh that cannot become a tree: ``title`` says what is wrong, ``hint`` what the user can do about it.

    ``code`` is a stable kebab-case name for programs, ``reason`` the kind of problem.
    """

    def __init__(self, code: str, reason: Reason, title: str, hint: str = "") -> None:
        super().__init__(f"{title} {hint}".strip())
        self.code = code
        self.reason: Reason = reason
        self.title = title
        self.hint = hint
