"""Rows and responses that cannot be serialised, because a name in them is not valid Unicode, for instance."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from typing import Any, TypeVar

from pydantic import BaseModel

from galewood_server.http.errors import ProblemError

log = logging.getLogger("galewood.rows")
Model = TypeVar("Model", bound=BaseModel)


def row_as_json(kind: str, model: type[BaseModel], values: Mapping[str, Any]) -> bytes | None:
    """A row of the database as JSON; None, with its id in the log, if it is damaged."""
    try:
        return model.model_validate(values).model_dump_json().encode()
    except (ValueError, TypeError, RecursionError) as error:
        log.error("the record of %s %a is damaged and left out: %a", kind, values.get("id"), str(error)[:500])
        return None


def serialisable(model: Model) -> Model:
    """The model, if it can be serialised. Call it before the transaction ends, so that nothing is stored that
    cannot be read again. ProblemError 500."""
    try:
        model.model_dump_json()
    except (ValueError, TypeError, RecursionError) as error:
        raise ProblemError(
            500,
            "unserialisable",
            "The result cannot be written as JSON",
            detail=f"Nothing was changed. {str(error)[:300]!a}",
            hint="A name in the request or in its file may not be valid Unicode.",
        ) from error
    return model


def damaged(kind: str, name: str, hint: str) -> ProblemError:
    """500 for a row of the database that cannot be read; the hint names the remedy."""
    return ProblemError(
        500,
        f"damaged-{kind}",
        f"This {kind}'s record is damaged",
        detail=f"The record of {name[:80]!a} in the database cannot be read.",
        hint=hint,
    )
