"""The hands that pull trees of one forest: who pulls what."""

from __future__ import annotations

from collections.abc import Sequence

from galewood.constants import MOST_PULLS_OF_FOREST

from galewood_server.stream.wire import Pull, Vector

ZERO_FORCE: Vector = (0.0, 0.0, 0.0)


class ForestHands:
    """The pulls that clients hold, by client. One per client; changed in the event loop, read by the step."""

    def __init__(self) -> None:
        self._held: dict[object, Pull] = {}

    def pull(self, client: object, pull: Pull) -> bool:
        """Begin or continue a pull; whether the forest has room for it."""
        if client not in self._held and len(self._held) >= MOST_PULLS_OF_FOREST:
            return False
        self._held = {**self._held, client: pull}
        return True

    def release(self, client: object) -> None:
        """Release the tree."""
        self._held = {one: pull for one, pull in self._held.items() if one is not client}

    @property
    def pulls(self) -> Sequence[Pull]:
        """All pulls; safe to read in another thread."""
        return tuple(self._held.values())
