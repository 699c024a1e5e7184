"""The latest values of a forest other than poses (clock, wind, description, clients), each encoded once."""

from __future__ import annotations

from galewood_server.stream.socket_protocol import binary_frame
from galewood_server.stream.wire import Clock, Presence, Pulls, Shared, WindState, encode_reply

Value = Clock | Presence | Pulls | Shared | WindState


class LatestValues:
    """The newest message of each type, numbered; clients fetch those after the last one sent."""

    def __init__(self) -> None:
        self.number = 0
        self._frames: dict[type[Value], tuple[int, bytes]] = {}

    def post(self, value: Value) -> None:
        """Replace the value of the same type."""
        self.number += 1
        self._frames[type(value)] = (self.number, binary_frame(encode_reply(value)))

    def since(self, number: int) -> list[bytes]:
        """WebSocket frames of the values newer than `number`, in order."""
        return [frame for value_number, frame in sorted(self._frames.values()) if value_number > number]
