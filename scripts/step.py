#!/usr/bin/env python3
"""Run a command of the Makefile and say how far it is: scripts/step.py NAME COMMAND [ARGUMENT ...]

What the command prints goes to build/log/NAME.log. Every 20 s its last line is shown, and at the end the time
and the CPU time that it took; all of it is shown only if the command fails. So steps that run side by side
can be told apart.
"""

from __future__ import annotations

import re
import resource
import subprocess
import sys
import time
from pathlib import Path

LOG_FOLDER = Path(__file__).resolve().parents[1] / "build" / "log"
INTERVAL_S = 20.0
COLOUR_CODE = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]")
SHOWN_LENGTH = 100


def lines_of(log: Path) -> list[str]:
    """The lines of a log that are not empty, without colours."""
    text = COLOUR_CODE.sub("", log.read_text(encoding="utf-8", errors="replace"))
    return [line.strip() for line in text.splitlines() if line.strip()]


def say(name: str, begin_s: float, words: str) -> None:
    """Print one line of a step: its name, the time since it began, and what there is to say."""
    passed_s = int(time.monotonic() - begin_s)
    print(f"{name:<12} {passed_s // 60}:{passed_s % 60:02d}  {words[:SHOWN_LENGTH]}", flush=True)


def _cpu_s() -> float:
    """CPU time of the command and of all that it started and waited for."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def main(name: str, command: list[str]) -> int:
    """Run the command; its exit status, or 1 if a signal ended it."""
    begin_s = time.monotonic()
    LOG_FOLDER.mkdir(parents=True, exist_ok=True)
    log = LOG_FOLDER / f"{name}.log"
    with (
        log.open("wb") as file,
        subprocess.Popen(command, stdout=file, stderr=subprocess.STDOUT) as process,
    ):
        while True:
            try:
                status = process.wait(INTERVAL_S)
                break
            except subprocess.TimeoutExpired:
                say(name, begin_s, (lines_of(log) or [""])[-1])
    if status == 0:
        result = next((line for line in reversed(lines_of(log)) if "passed" in line), "done")
        say(name, begin_s, f"{result}; {_cpu_s():.0f} s of CPU")
        return 0
    print(log.read_text(encoding="utf-8", errors="replace"), flush=True)
    say(name, begin_s, f"failed: {' '.join(command)}")
    return max(status, 1)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2:]))
