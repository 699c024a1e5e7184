"""Query parameters that a route does not declare are refused: a misspelt one would be ignored silently."""

from __future__ import annotations

import inspect
from collections.abc import Iterable
from difflib import get_close_matches
from typing import Annotated, Any

from fastapi import Query
from fastapi.dependencies.models import Dependant
from fastapi.routing import APIRoute
from pydantic import BaseModel
from starlette.requests import HTTPConnection

from galewood_server.http.errors import ProblemError

SHOWN_LETTERS = 40
"""Of an unknown name in an error."""

ContentVersion = Annotated[
    str,
    Query(
        alias="version",
        max_length=64,
        description="Any text, without effect: a page names the hash of the picture's content here, so that "
        "another content has another address.",
    ),
]


async def refuse_unknown_queries(connection: HTTPConnection) -> None:
    """A dependency of all routes: 422 for a query parameter that the route does not declare. ProblemError.

    The route of the socket answers by the wire protocol instead, with `check_query`.
    """
    route = connection.scope["route"]
    if connection.query_params and isinstance(route, APIRoute):
        check_query(connection.query_params, query_names(route.dependant))


def check_query(given: Iterable[str], known: set[str]) -> None:
    """ProblemError 422 for the first name, in alphabetic order, that is not known."""
    for name in sorted(set(given) - known):
        nearest = get_close_matches(name, known, 1)
        guess = f"Did you mean {nearest[0]!r}? " if nearest else ""
        names = ", ".join(sorted(known))
        raise ProblemError(
            422,
            "unknown-parameter",
            f"Unknown query parameter {name[:SHOWN_LETTERS]!r}",
            hint=guess + (f"Parameters of this address: {names}." if known else "This address takes none."),
        )


def query_names(dependant: Dependant) -> set[str]:
    """Names of the query parameters of a route, also those of its dependencies and of models."""
    found = set[str]()
    for parameter in dependant.query_params:
        annotation: Any = parameter.field_info.annotation
        if inspect.isclass(annotation) and issubclass(annotation, BaseModel):
            found |= {field.alias or name for name, field in annotation.model_fields.items()}
        else:
            found.add(parameter.alias)
    return found.union(*(query_names(inner) for inner in dependant.dependencies))
