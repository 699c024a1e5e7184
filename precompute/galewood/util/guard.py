"""A small program between a parent and its child: neither the child nor its descendants outlive the parent.

``python -IS guard.py LIFELINE NICENESS PROGRAM ARGUMENTS…`` runs a program and ends as it ends. Descriptor
LIFELINE is the read end of a pipe whose write end only the parent holds. When that is closed, by the parent
or because the parent has died, the guard kills all descendants, waits until none is left, and ends. A process
that starts meanwhile cannot escape: the guard is the subreaper of its descendants (prctl(2)), so those that
lose their parent become its own children. If the guard itself is killed, the kernel kills the program. It
uses the standard library alone, so that it starts within some 20 ms.
"""

from __future__ import annotations

import ctypes
import os
import resource
import select
import signal
import sys
import time
from contextlib import suppress
from pathlib import Path
from types import FrameType
from typing import NoReturn

PR_SET_PDEATHSIG, PR_SET_CHILD_SUBREAPER = 1, 36
PARENT_CHECK_S = 1.0
"""Time between two looks for the parent, s: its end closes the lifeline, unless a fork of it holds a copy."""
SEARCH_S = 0.01
"""Time between two searches for descendants that are still there, s."""
EXIT_WITHOUT_PARENT = 1
EXIT_NOT_STARTED = 127


def main(lifeline: int, niceness: int, program: list[str]) -> NoReturn:
    """Run ``program`` until it ends or the parent lets go; never returns."""
    parent, guard = os.getppid(), os.getpid()
    os.set_inheritable(lifeline, False)
    woken = _wake_on(signal.SIGCHLD, signal.SIGTERM)
    _set_process_option(PR_SET_CHILD_SUBREAPER, 1)
    child = os.fork()
    if child == 0:
        _become(program, niceness, guard)
    status = _wait(child, parent, lifeline, woken)
    _kill_descendants()
    _end_like(status)


def _wake_on(*signals: signal.Signals) -> int:
    """A descriptor that becomes readable when one of the signals arrives: their numbers, as bytes."""
    woken, wake = os.pipe()
    os.set_blocking(wake, False)
    signal.set_wakeup_fd(wake, warn_on_full_buffer=False)
    for number in signals:
        signal.signal(number, _ignore)  # SIG_IGN would wake nobody
    return woken


def _ignore(_number: int, _frame: FrameType | None) -> None: ...


def _set_process_option(option: int, value: int) -> None:
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(option, value, 0, 0, 0)


def _become(program: list[str], niceness: int, guard: int) -> NoReturn:
    """Replace this process by the program, which the kernel kills when the guard ends."""
    try:
        signal.set_wakeup_fd(-1)
        for number in (signal.SIGCHLD, signal.SIGTERM, signal.SIGPIPE, signal.SIGXFSZ):
            signal.signal(number, signal.SIG_DFL)
        _set_process_option(PR_SET_PDEATHSIG, signal.SIGKILL)
        if os.getppid() == guard:  # otherwise it died before that signal was asked for
            os.nice(niceness)
            os.execvp(program[0], program)
    except OSError as error:
        print(f"{program[0]} could not be started: {error}", file=sys.stderr, flush=True)
    finally:
        os._exit(EXIT_NOT_STARTED)


def _wait(child: int, parent: int, lifeline: int, woken: int) -> int | None:
    """The status of the program once it ends; None if the parent lets go or has gone before."""
    while True:
        ready, _, _ = select.select([lifeline, woken], [], [], PARENT_CHECK_S)
        if lifeline in ready or os.getppid() != parent:
            return None
        if woken in ready and signal.SIGTERM in os.read(woken, 4096):
            return None
        ended, _ = _reap()
        if child in ended:
            return ended[child]


def _reap() -> tuple[dict[int, int], bool]:
    """Children that have ended, adopted ones too, with their statuses; and whether there are others."""
    ended: dict[int, int] = {}
    try:
        while True:
            pid, status = os.waitpid(-1, os.WNOHANG)
            if pid == 0:
                return ended, True
            ended[pid] = status
    except ChildProcessError:
        return ended, False


def _kill_descendants() -> None:
    """Kill all descendants and wait for their end.

    All are stopped first, from the top down, so that none starts new ones and none notices the end of
    another: a program that is just starting reads from its parent, and would report a broken pipe. A signal
    takes effect a little later, so what a process still starts is found by the next search.
    """
    while _reap()[1]:
        if sys.platform != "linux":
            os.killpg(0, signal.SIGKILL)  # this process too
        found = dict[int, None]()
        while new := [pid for pid in _descendants() if pid not in found]:
            for pid in new:
                found[pid] = None
                _send(pid, signal.SIGSTOP)
        for pid in found:
            _send(pid, signal.SIGKILL)
        time.sleep(SEARCH_S)


def _descendants() -> list[int]:
    """The descendants of this process, parents before their children."""
    children: dict[int, list[int]] = {}
    for entry in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = entry.read_bytes().rpartition(b")")[2].split()
        except OSError:
            continue  # it has just ended
        children.setdefault(int(fields[1]), []).append(int(entry.parent.name))
    found = [os.getpid()]
    for pid in found:  # which grows meanwhile
        found += children.get(pid, [])
    return found[1:]


def _send(pid: int, number: signal.Signals) -> None:
    with suppress(ProcessLookupError):
        os.kill(pid, number)


def _end_like(status: int | None) -> NoReturn:
    """End with the exit code of the program, or by the signal that ended it."""
    if status is None:
        os._exit(EXIT_WITHOUT_PARENT)
    if os.WIFEXITED(status):
        os._exit(os.WEXITSTATUS(status))
    number = os.WTERMSIG(status)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if number not in (signal.SIGKILL, signal.SIGSTOP):
        signal.signal(number, signal.SIG_DFL)
    os.kill(os.getpid(), number)
    os._exit(128 + number)


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]), sys.argv[3:])
