"""Runs graphs of KHR_interactivity by the text of its specification: the operations of live trees."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

OPERATIONS: dict[str, Callable[..., Any]] = {
    "math/add": lambda a, b: a + b,
    "math/sub": lambda a, b: a - b,
    "math/mul": lambda a, b: a * b,
    "math/div": lambda a, b: a / b,
    "math/min": min,
    "math/max": max,
    "math/mix": lambda a, b, c: (1 - c) * a + c * b,
    "math/pow": lambda a, b: a**b,
    "math/log": math.log,
    "math/cos": math.cos,
    "math/fract": lambda a: a - math.floor(a),
    "math/isNaN": math.isnan,
    "math/select": lambda condition, a, b: a if condition else b,
    "math/length": lambda a: math.hypot(*a),
    "math/dot": lambda a, b: float(a @ b),
    "math/rotate2D": lambda a, angle: np.array([
        a[0] * math.cos(angle) - a[1] * math.sin(angle), a[0] * math.sin(angle) + a[1] * math.cos(angle),
    ]),
    "math/combine2": lambda a, b: np.array([a, b]),
    "math/combine4": lambda a, b, c, d: np.array([a, b, c, d]),
    "type/floatToInt": int,
}  # fmt: skip
ALIKE = {"math/add", "math/sub", "math/mul", "math/div", "math/mix", "math/dot"}
"""Operations whose inputs have one type."""


class Graph:
    """A graph at its start; ``weights``: what it has set, by pointer."""

    def __init__(self, document: dict[str, Any]) -> None:
        self._nodes = document["nodes"]
        self._operations = [declaration["op"] for declaration in document["declarations"]]
        self.variables = [_typed(one["value"]) for one in document["variables"]]
        self._events = document["events"]
        self._tick: dict[str, float] = {}
        self._heard: dict[str, Any] = {}
        self.weights: dict[str, float] = {}

    def tick(self, since_start_s: float, since_last_s: float) -> None:
        """A tick; the first one has no time since the last: it is not a number."""
        self._tick = {"timeSinceStart": since_start_s, "timeSinceLastTick": since_last_s}
        self._begin("event/onTick")

    def hear(self, **values: float) -> None:
        """The only event; sockets that are left out have their initial values."""
        (event,) = self._events
        self._heard = {name: values.get(name, one["value"][0]) for name, one in event["values"].items()}
        self._begin("event/receive")

    def _operation(self, index: int) -> str:
        return self._operations[self._nodes[index]["declaration"]]

    def _begin(self, operation: str) -> None:
        for index in range(len(self._nodes)):
            if self._operation(index) == operation:
                self._follow(index, "out")

    def _follow(self, index: int, flow: str) -> None:
        following = self._nodes[index].get("flows", {}).get(flow)
        if following:
            self._run(following["node"])

    def _run(self, index: int) -> None:
        node, operation, known = self._nodes[index], self._operation(index), dict[int, Any]()
        if operation == "flow/sequence":
            for flow in sorted(node["flows"]):
                self._follow(index, flow)
        elif operation == "flow/for":
            for _ in range(self._input(index, "startIndex", known), self._input(index, "endIndex", known)):
                self._follow(index, "loopBody")
            self._follow(index, "completed")
        elif operation == "variable/set":
            chosen = node["configuration"]["variables"]["value"]
            for variable, value in {one: self._input(index, str(one), known) for one in chosen}.items():
                assert np.shape(value) == np.shape(self.variables[variable])
                self.variables[variable] = value
        else:
            assert operation == "pointer/set", operation
            self.weights[node["configuration"]["pointer"]["value"][0]] = self._input(index, "value", known)

    def _input(self, index: int, socket: str, known: dict[int, Any]) -> Any:
        given = self._nodes[index]["values"][socket]
        return self._output(given, known) if "node" in given else _typed(given["value"])

    def _output(self, given: dict[str, Any], known: dict[int, Any]) -> Any:
        index = given["node"]
        node, operation = self._nodes[index], self._operation(index)
        if operation == "event/onTick":
            return self._tick[given["socket"]]
        if operation == "event/receive":
            return self._heard[given["socket"]]
        if operation == "variable/get":
            return self.variables[node["configuration"]["variable"]["value"][0]]
        if index not in known:
            inputs = {name: self._input(index, name, known) for name in node["values"]}
            if operation in ALIKE:
                assert len({np.shape(value) for value in inputs.values()}) == 1, operation
            ordered = (inputs[name] for name in sorted(inputs, key=lambda name: (name != "condition", name)))
            known[index] = OPERATIONS[operation](*ordered)
        return known[index]


def _typed(value: list[Any]) -> Any:
    return value[0] if len(value) == 1 else np.array(value, np.float64)
