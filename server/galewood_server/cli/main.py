"""The program `galewood`."""

from __future__ import annotations

import os
import sys

from galewood.interrupts import ended_by_interrupts
from galewood.threads import SINGLE_THREADED

SERVING_COMMANDS = (["serve"], ["forest"])
"""Beginnings of the arguments with which a server starts."""


def main() -> None:
    """Run a command, the numerical libraries limited to one thread each.

    Work is spread over processes, so the libraries' own threads would only compete with each other; and a
    table must not depend on their number. BLAS reads the limit when numpy is loaded, hence the late import.
    """
    for name, value in SINGLE_THREADED.items():
        os.environ.setdefault(name, value)
    with ended_by_interrupts(even_if_ignored=sys.argv[1:2] in SERVING_COMMANDS):
        from galewood_server.cli.commands import app

    app()


if __name__ == "__main__":
    main()
