"""Fields of a wind document: ranges, errors and reading of single values."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from numbers import Real
from typing import cast

from galewood.constants import WIND_MODELS


@dataclass(frozen=True)
class Field:
    """A numeric field: its range, the models that have it, and its default (None: required)."""

    low: float
    high: float
    models: tuple[str, ...] = WIND_MODELS
    default: float | None = None
    whole: bool = False

    @property
    def expected(self) -> str:
        """The accepted range as text."""
        kind = "a whole number" if self.whole else "a number"
        return f"expected {kind} in {self.low:.10g}..{self.high:.10g}"


class WindError(ValueError):
    """A wind document that cannot be parsed: the path of the field and what is accepted there."""

    def __init__(self, path: str, expected: str, found: str = "") -> None:
        """``found`` is appended to the message to show the rejected value; empty if that does not help."""
        super().__init__(f"{path}: {expected}{found}")
        self.path = path
        self.expected = expected


def object_at(value: object, path: str) -> Mapping[object, object]:
    if not isinstance(value, Mapping):
        raise WindError(path, "expected an object")
    return cast(Mapping[object, object], value)


def refuse_unknown(fields: Mapping[object, object], known: Sequence[str], path: str, why: str) -> None:
    for name in fields:
        if name not in known:
            raise WindError(f"{path}.{str(name)[:40]}", why)


def found_text(value: object) -> str:
    return "" if value is None else f", not {value!r:.40}"


def checked(value: object, rule: Field, path: str) -> float:
    """A number within the range of its field. WindError; NaN is in no range."""
    if isinstance(value, bool) or not isinstance(value, Real):
        raise WindError(path, rule.expected, found_text(value))
    number = float(value)
    if not rule.low <= number <= rule.high or (rule.whole and number != math.floor(number)):
        raise WindError(path, rule.expected, found_text(value))
    return number


def number_at(fields: Mapping[object, object], name: str, rule: Field, path: str) -> float:
    if name not in fields:
        if rule.default is None:
            raise WindError(f"{path}.{name}", f"missing, {rule.expected}")
        return rule.default
    return checked(fields[name], rule, f"{path}.{name}")
