"""Limits how often the same message is logged, so that strangers cannot fill the disk with it."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from dataclasses import dataclass

BURST_LINES, WINDOW_S = 20, 60.0
MOST_MESSAGES = 1000


@dataclass
class _Window:
    began_s: float
    count: int = 0


class Throttle(logging.Filter):
    """Lets a message through a few times a minute; after that minute it says how many more there were.

    Messages are the same if their texts are the same before arguments are inserted. Request lines are the
    exception: each address may send as many requests as the rate limit allows.
    """

    def __init__(self, unlimited: str, now_s: Callable[[], float] = time.monotonic) -> None:
        super().__init__()
        self._unlimited = unlimited
        self._now_s = now_s
        self._windows: dict[tuple[str, str], _Window] = {}

    def filter(self, record: logging.LogRecord) -> bool:
        """Whether to log a record."""
        if record.name == self._unlimited:
            return True
        key, now_s = (record.name, str(record.msg)), self._now_s()
        window = self._windows.get(key)
        if window is None or now_s - window.began_s >= WINDOW_S:
            if window is None and len(self._windows) >= MOST_MESSAGES:
                self._windows.clear()
            suppressed = max(0, window.count - BURST_LINES) if window else 0
            if suppressed:
                record.msg = f"{record.msg} (and {suppressed} times more since the last such line)"
            window = self._windows[key] = _Window(now_s)
        window.count += 1
        return window.count <= BURST_LINES
