"""Texts of requests that become part of queries and rows.

PostgreSQL has no NUL, and neither database has lone surrogates. What other people see is cleaned besides, by
the rule for text from files.
"""

from __future__ import annotations

from typing import Annotated

from galewood.util import shown_text
from pydantic import AfterValidator


def is_storable(text: str) -> bool:
    """Whether a text has neither NUL characters nor lone surrogates."""
    return "\0" not in text and not any("\ud800" <= char <= "\udfff" for char in text)


def _storable(text: str) -> str:
    if not is_storable(text):
        raise ValueError("NUL characters are not allowed")
    return text


StorableText = Annotated[str, AfterValidator(_storable)]
"""A field of a request that becomes part of a query or of a row."""
AS_SHOWN = AfterValidator(lambda text: shown_text(_storable(text)))
"""Marks a field that is stored to be shown: its text cannot pretend to be something else."""
