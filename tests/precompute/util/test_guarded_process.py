"""Child processes and all that they start end with their parent, whatever it or they are doing."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

import psutil
import pytest
from galewood.util import AbortedError, GuardedProcess, guarded_process
from galewood.util.guarded_process import GUARD_SCRIPT

# A family that keeps growing: each process starts children in sessions of their own, whose parents then end.
GROWING = """
import os, subprocess, sys, time
folder, depth = sys.argv[1], int(sys.argv[2])
open(os.path.join(folder, str(os.getpid())), "w").close()
while True:
    if depth < 3:
        child = [sys.executable, "-IS", __file__, folder, str(depth + 1)]
        subprocess.Popen(child, start_new_session=True)
    if depth == 2:
        break  # its child is an orphan
    time.sleep(0.02)
"""
WAITING = "import os, sys, time; open(f'{sys.argv[1]}/{os.getpid()}', 'w').close(); time.sleep(600)"
PARENT = """
import os, subprocess, sys, time
from pathlib import Path
from galewood.util import GuardedProcess
with open(os.devnull, "wb") as nowhere:
    child = GuardedProcess(sys.argv[2:], cwd=Path(sys.argv[1]), environment=os.environ, errors=nowhere)
    print("started", flush=True)
    child.wait(600)
"""


def growing_family(folder: Path) -> list[str]:
    """A program that starts processes endlessly; each one leaves a file named by its id in `folder`."""
    script = folder.parent / "growing.py"
    script.write_text(GROWING)
    return [sys.executable, "-IS", str(script), str(folder), "0"]


def living(folder: Path) -> list[int]:
    """The members of a family that still run (zombies do not)."""
    found: list[int] = []
    for file in folder.iterdir():
        try:
            if psutil.Process(int(file.name)).status() != psutil.STATUS_ZOMBIE:
                found.append(int(file.name))
        except psutil.NoSuchProcess:
            continue
    return found


def wait_for_members(folder: Path, count: int) -> None:
    end_s = time.monotonic() + 120
    while len(list(folder.iterdir())) < count:
        assert time.monotonic() < end_s, "the family does not grow"
        time.sleep(0.005)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    made = tmp_path / "members"
    made.mkdir()
    return made


def guarded(program: list[str], folder: Path) -> GuardedProcess:
    with Path(os.devnull).open("wb") as nowhere:
        return GuardedProcess(program, cwd=folder, environment=dict(os.environ), errors=nowhere)


def test_a_family_that_keeps_growing_ends_with_the_block(folder: Path) -> None:
    with guarded(growing_family(folder), folder):
        wait_for_members(folder, 30)
    assert not living(folder)


@pytest.mark.parametrize("killed", ["parent", "guard"])
def test_a_family_ends_when_its_parent_or_guard_is_killed(folder: Path, killed: str) -> None:
    command = [sys.executable, "-c", PARENT, str(folder.parent), sys.executable, "-c", WAITING, str(folder)]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as parent:
        assert parent.stdout and parent.stdout.readline() == b"started\n"
        wait_for_members(folder, 1)
        (guard,) = psutil.Process(parent.pid).children()
        (guard if killed == "guard" else parent).kill()
        for file in folder.iterdir():
            with suppress(psutil.NoSuchProcess):
                psutil.Process(int(file.name)).wait(60)
        parent.kill()
    assert not living(folder)


def test_a_parent_killed_at_random_moments_leaves_nobody(folder: Path) -> None:
    seed = random.randrange(1 << 32)
    print(f"seed {seed}")
    dice = random.Random(seed)
    program = growing_family(folder)
    for _ in range(12):
        command = [sys.executable, "-c", PARENT, str(folder.parent), *program]
        with subprocess.Popen(command, stdout=subprocess.PIPE) as parent:
            assert parent.stdout and parent.stdout.readline() == b"started\n"
            guards = psutil.Process(parent.pid).children()
            time.sleep(dice.uniform(0.0, 0.3))  # no condition: a moment of its start
            parent.kill()
            psutil.wait_procs(guards, 120)
            assert not any(guard.is_running() for guard in guards)
        assert not living(folder)


@pytest.mark.parametrize(
    ("program", "code"),
    [
        ("pass", 0),
        ("raise SystemExit(7)", 7),
        ("import os; os.abort()", -signal.SIGABRT),
        ("import os; os.kill(os.getpid(), 9)", -signal.SIGKILL),
        ("import os; os.kill(os.getpid(), 24)", -signal.SIGXCPU),
    ],
)
def test_the_guard_ends_like_the_program(folder: Path, program: str, code: int) -> None:
    with guarded([sys.executable, "-ISc", program], folder) as child:
        assert child.wait(120) == code


def test_descendants_of_a_program_that_ended_are_killed(folder: Path) -> None:
    start = (
        "import subprocess, sys;"
        "subprocess.Popen([sys.executable, '-ISc', sys.argv[1], sys.argv[2]], start_new_session=True)"
    )
    program = [sys.executable, "-ISc", start, WAITING, str(folder)]
    with guarded(program, folder) as child:
        assert child.wait(120) == 0
    assert not living(folder)


def test_a_process_ends_while_a_thread_waits_for_it(folder: Path) -> None:
    def wait() -> None:
        with guarded(growing_family(folder), folder) as child:
            child.wait(600)

    with ThreadPoolExecutor(1) as threads:
        waiting = threads.submit(wait)
        wait_for_members(folder, 10)
        GuardedProcess.end_all()
        assert not living(folder)
        with pytest.raises(AbortedError):
            waiting.result(60)


def test_a_frozen_guard_is_killed_with_its_program(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(guarded_process, "FROZEN_S", 0.1)
    with guarded([sys.executable, "-ISc", WAITING, str(folder)], folder):
        wait_for_members(folder, 1)
        (guard,) = [one for one in psutil.Process().children() if str(GUARD_SCRIPT) in one.cmdline()]
        guard.suspend()
    psutil.wait_procs([psutil.Process(int(file.name)) for file in folder.iterdir()], 60)
    assert not living(folder)


def test_a_program_that_does_not_exist_is_an_error(folder: Path) -> None:
    with tempfile.TemporaryFile() as errors:
        with GuardedProcess(
            [str(folder / "nothing")], cwd=folder, environment=dict(os.environ), errors=errors
        ) as child:
            assert child.wait(120) == 127
        errors.seek(0)
        assert b"could not be started" in errors.read()
