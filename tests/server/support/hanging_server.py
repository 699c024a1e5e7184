"""A server whose import process never ends: `python -m tests.server.support.hanging_server`."""

from __future__ import annotations

import time
from typing import Any

from galewood.interrupts import ended_by_interrupts

with ended_by_interrupts(even_if_ignored=True):  # as in `galewood serve`
    import numpy as np
    from galewood.sandbox import Arrays, Limits, run_limited
    from galewood_server.app.main import create_app, run
    from galewood_server.settings import Settings


def hang(arguments: Arrays) -> Arrays:
    time.sleep(3600)
    return arguments


def importer(data: bytes, filename: str, options: Any) -> Any:
    arguments = {"data": np.frombuffer(data, np.uint8)}
    return run_limited("tests.server.support.hanging_server:hang", arguments, Limits(), what="The import")


if __name__ == "__main__":
    settings = Settings()
    run(create_app(settings, importer), settings)
