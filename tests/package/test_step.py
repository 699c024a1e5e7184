"""`scripts/step.py`: a step that passes is one line, one that fails shows what it printed."""

import re
import subprocess
import sys
from pathlib import Path

STEP = Path(__file__).resolve().parents[2] / "scripts" / "step.py"


def step(tmp_path: Path, program: str) -> subprocess.CompletedProcess[str]:
    """A copy of the script, whose logs go to a folder of the test, with a Python program as its command."""
    copy = tmp_path / "scripts" / "step.py"
    copy.parent.mkdir()
    copy.write_text(STEP.read_text())
    return subprocess.run(
        [sys.executable, str(copy), "name", sys.executable, "-c", program],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def test_a_step_that_passes_shows_its_summary_alone(tmp_path: Path) -> None:
    run = step(tmp_path, "print('\\x1b[32m.... [100%]\\x1b[0m'); print('2 passed in 0.10s\\n')")
    assert run.returncode == 0
    last = run.stdout.splitlines()[-1]
    assert re.fullmatch(r"name +\d+:\d\d +2 passed in 0\.10s; \d+ s of CPU", last), last
    assert "[100%]" in (tmp_path / "build" / "log" / "name.log").read_text()


def test_a_step_that_fails_shows_everything_and_fails(tmp_path: Path) -> None:
    run = step(tmp_path, "import sys; print('first'); print('second', file=sys.stderr); sys.exit(3)")
    assert run.returncode == 3
    assert "first" in run.stdout and "second" in run.stdout and "failed: " in run.stdout


def test_a_step_that_a_signal_ends_fails(tmp_path: Path) -> None:
    assert step(tmp_path, "import os; os.kill(os.getpid(), 9)").returncode == 1
