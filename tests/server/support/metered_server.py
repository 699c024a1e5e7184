"""A server that writes down what keeps its event loop: `python -m tests.server.support.metered_server`.

METER_FILE gets a line for each callback of the event loop that needed LEAST_MS of processor time, and for
each stretch of another thread that held the interpreter that long: without a call from Python, or in a
function that does not release it. Processor times are nearly the same on a busy machine.
"""

from __future__ import annotations

import asyncio.events
import json
import os
import threading
import time
from pathlib import Path
from types import FrameType
from typing import Any

from galewood_server.app.main import create_app, run
from galewood_server.settings import Settings

LEAST_MS = 2.0
RELEASING = frozenset({
    "openssl_sha256", "update", "crc32", "compress", "flush", "decompress", "read", "readinto", "write",
    "execute", "fetchall", "fetchmany", "commit", "connect",
})  # fmt: skip
"""Built-in functions that let other threads run while they work."""


class Meter:
    """Lines of JSON: `thread` ("loop" or "other"), `ms`, `what`."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def note(self, thread: str, seconds: float, what: object) -> None:
        """Write down a time that is worth it."""
        if 1e3 * seconds >= LEAST_MS:
            line = json.dumps({"thread": thread, "ms": 1e3 * seconds, "what": str(what)[:300]})
            with self._path.open("a") as file:
                file.write(f"{line}\n")


def meter_callbacks(meter: Meter) -> None:
    """Measure every callback of event loops."""
    run_callback = asyncio.events.Handle._run

    def measured(self: asyncio.events.Handle) -> None:
        began_s = time.thread_time()
        run_callback(self)
        meter.note("loop", time.thread_time() - began_s, self)

    asyncio.events.Handle._run = measured  # type: ignore[method-assign]


def meter_threads(meter: Meter) -> None:
    """Measure how long threads that start from now on work without a chance for others."""
    state = threading.local()

    def profile(frame: FrameType, event: str, argument: Any) -> None:
        now_s = time.thread_time()
        releases = event == "c_return" and getattr(argument, "__name__", "") in RELEASING
        if not releases:
            name = getattr(argument, "__qualname__", "") if event.startswith("c_") else ""
            meter.note("other", now_s - getattr(state, "last_s", now_s), f"{frame.f_code.co_qualname} {name}")
        state.last_s = time.thread_time()

    threading.setprofile(profile)


if __name__ == "__main__":
    settings = Settings()
    meter = Meter(Path(os.environ["METER_FILE"]))
    meter_callbacks(meter)
    meter_threads(meter)
    run(create_app(settings), settings)
