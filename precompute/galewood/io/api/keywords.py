"""Options of a call as keywords: their names, types and defaults are those of the fields of a model."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import wraps
from typing import Concatenate, ParamSpec, TypeVar, get_type_hints

Keywords = ParamSpec("Keywords")
Subject = TypeVar("Subject")
Options = TypeVar("Options")
Result = TypeVar("Result")


def with_keywords_of(
    model: Callable[Keywords, Options],
) -> Callable[[Callable[[Subject, Options], Result]], Callable[Concatenate[Subject, Keywords], Result]]:
    """Make a function of a subject and a model's instance one that takes the model's fields as keywords.

    Type checkers and editors see the fields, and so does ``help``.
    """

    def changed(
        function: Callable[[Subject, Options], Result],
    ) -> Callable[Concatenate[Subject, Keywords], Result]:
        @wraps(function)
        def call(subject: Subject, /, *args: Keywords.args, **kwargs: Keywords.kwargs) -> Result:
            return function(subject, model(*args, **kwargs))

        inner, types = inspect.signature(function), get_type_hints(model)
        first = next(iter(inner.parameters.values())).replace(kind=inspect.Parameter.POSITIONAL_ONLY)
        fields = inspect.signature(model).parameters.values()
        parameters = [first, *(one.replace(annotation=types[one.name]) for one in fields)]
        call.__signature__ = inner.replace(parameters=parameters)  # type: ignore[attr-defined]
        return call

    return changed
