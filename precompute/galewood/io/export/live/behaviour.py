"""Behaviour graphs of the glTF extension KHR_interactivity, written node by node.

Names of operations, sockets and configurations, and the JSON, are those of its ratified specification.
"""

from __future__ import annotations

from typing import Any, NamedTuple

FLOAT_TYPES = ("float", "float2", "float3", "float4")
INT_TYPE = "int"
TYPES = (*FLOAT_TYPES, INT_TYPE)


class Value(NamedTuple):
    """An output of a node."""

    node: int
    socket: str = "value"


class Constant(NamedTuple):
    """Numbers that a node is given: as many as its type has."""

    numbers: tuple[float, ...]
    kind: str


Input = Value | Constant


def numbers(*values: float) -> Constant:
    """A float, or a vector of two to four."""
    return Constant(tuple(float(value) for value in values), FLOAT_TYPES[len(values) - 1])


def whole(value: int) -> Constant:
    """An int."""
    return Constant((value,), INT_TYPE)


class Behaviour:
    """A graph under construction: variables, one event, and nodes in the order in which they were added."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._variables: list[dict[str, Any]] = []
        self._events: list[dict[str, Any]] = []
        self._operations: list[str] = []
        self._nodes: list[dict[str, Any]] = []

    def variable(self, name: str, *values: float) -> int:
        """Add a variable of one to four floats; its index. The extras hold its name."""
        kind = TYPES.index(FLOAT_TYPES[len(values) - 1])
        start = [float(value) for value in values]
        self._variables.append({"type": kind, "value": start, "extras": {"name": name}})
        return len(self._variables) - 1

    def event(self, name: str, values: dict[str, float]) -> int:
        """Add a custom event with float sockets and what they hold where the sender leaves them out; its
        index."""
        kind = TYPES.index("float")
        sockets = {socket: {"type": kind, "value": [float(value)]} for socket, value in values.items()}
        self._events.append({"id": name, "values": sockets})
        return len(self._events) - 1

    def node(self, operation: str, inputs: dict[str, Input] | None = None, **configuration: Any) -> int:
        """Add a node; its index. A configuration is a number, a text or a list."""
        if operation not in self._operations:
            self._operations.append(operation)
        added: dict[str, Any] = {"declaration": self._operations.index(operation)}
        if inputs:
            added["values"] = {socket: _source(given) for socket, given in inputs.items()}
        if configuration:
            added["configuration"] = {
                key: {"value": given if isinstance(given, list) else [given]}
                for key, given in configuration.items()
            }
        self._nodes.append(added)
        return len(self._nodes) - 1

    def value(self, operation: str, *inputs: Input) -> Value:
        """Add a node whose inputs are called a, b, c, …; its output."""
        return Value(self.node(operation, dict(zip("abcd", inputs, strict=False))))

    def get(self, variable: int) -> Value:
        """The value of a variable."""
        return Value(self.node("variable/get", variable=variable))

    def set(self, values: dict[int, Input]) -> int:
        """A node that sets variables at once, after all values are known."""
        inputs = {str(variable): given for variable, given in values.items()}
        return self.node("variable/set", inputs, variables=list(values))

    def point(self, pointer: str, given: Input) -> int:
        """A node that sets a float of the asset's object model."""
        return self.node("pointer/set", {"value": given}, pointer=pointer, type=TYPES.index("float"))

    def then(self, node: int, following: int, flow: str) -> int:
        """Continue a flow of a node with another one, which is returned."""
        self._nodes[node].setdefault("flows", {})[flow] = {"node": following}
        return following

    def document(self) -> dict[str, Any]:
        """The graph as JSON."""
        return {
            "name": self._name,
            "types": [{"signature": kind} for kind in TYPES],
            "variables": self._variables,
            "events": self._events,
            "declarations": [{"op": operation} for operation in self._operations],
            "nodes": self._nodes,
        }


def _source(given: Input) -> dict[str, Any]:
    if isinstance(given, Value):
        socket = {} if given.socket == "value" else {"socket": given.socket}
        return {"node": given.node, **socket}
    return {"type": TYPES.index(given.kind), "value": list(given.numbers)}
