"""The methods that play a table."""

from __future__ import annotations

from typing import Literal, get_args

Method = Literal["modal", "paper"]
"""The modal reduced-order model, or the paper's state search."""
METHOD_NAMES: tuple[Method, ...] = get_args(Method)
METHOD_HELP = "modal: the default method; paper: the state search of the paper."
