"""Ctrl-C while a program loads its modules ends it, whatever the interpreter is doing."""

from __future__ import annotations

import signal
import threading
from collections.abc import Generator
from contextlib import contextmanager


@contextmanager
def ended_by_interrupts(*, even_if_ignored: bool = False) -> Generator[None]:
    """While this runs, SIGINT ends the process without a traceback, as SIGTERM does.

    Python would raise KeyboardInterrupt at the next step of the interpreter, which is often in a callback of
    the import system or in a finaliser: those only print their exceptions, and the program would go on. Use
    it where nothing needs to be cleaned up.

    Args:
        even_if_ignored: Shells ignore SIGINT for what scripts start in the background, and so it stays by
            default. True, for servers, which listen to it in any case once they run: it counts from now on.
    """
    own = signal.getsignal(signal.SIGINT)
    if even_if_ignored and own is signal.SIG_IGN:
        own = signal.default_int_handler
    if own is not signal.default_int_handler or threading.current_thread() is not threading.main_thread():
        yield
        return
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, own)
