"""What a forest has to tell besides poses: of each kind the newest, encoded once."""

from __future__ import annotations

from galewood_server.stream.socket_protocol import binary_frame
from galewood_server.stream.wire import Clock, Shared, WindState, encode_reply

News = Clock | Shared | WindState


class LatestValues:
    """News with rising numbers; who has seen number n needs only what is newer, the newest of each kind."""

    def __init__(self) -> None:
        self.number = 0
        self._frames: dict[type[News], tuple[int, bytes]] = {}

    def post(self, news: News) -> None:
        """In place of what was said of the kind before."""
        self.number += 1
        self._frames[type(news)] = (self.number, binary_frame(encode_reply(news)))

    def since(self, number: int) -> list[bytes]:
        """What is newer, in order, ready for the socket."""
        return [frame for posted, frame in sorted(self._frames.values()) if posted > number]
