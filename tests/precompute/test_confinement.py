"""What a child that reads a stranger's mesh can no longer do, on machines that can lock it in."""

import os
import socket
from pathlib import Path

import numpy as np
import pytest
from galewood.sandbox.confinement import missing_here
from galewood.sandbox.limited_process import Arrays, Limits, run_limited

HERE = "tests.precompute.test_confinement"


def try_everything(arguments: Arrays) -> Arrays:
    """Which of these a child manages: 1, or 0 where it is refused."""
    outside = Path(arguments["outside"].tobytes().decode())
    attempts = {
        "write_own": lambda: Path("own").write_text("x"),
        "read_system": lambda: Path("/etc/passwd").read_bytes(),
        "write_outside": lambda: (outside / "new").write_text("x"),
        "read_outside": lambda: (outside / "secret").read_text(),
        "remove_outside": lambda: (outside / "secret").unlink(),
        "read_parent": lambda: Path(f"/proc/{os.getppid()}/environ").read_bytes(),
        "signal_parent": lambda: os.kill(os.getppid(), 0),
        "tcp": lambda: socket.socket(),
        "udp": lambda: socket.socket(socket.AF_INET, socket.SOCK_DGRAM),
        "unix": lambda: socket.socket(socket.AF_UNIX),
    }
    return {name: np.array(_managed(attempt)) for name, attempt in attempts.items()}


def _managed(attempt) -> int:
    try:
        attempt()
    except OSError:
        return 0
    return 1


@pytest.mark.skipif(bool(missing_here()), reason="this kernel has no Landlock or no seccomp")
def test_a_child_keeps_to_its_folder_and_has_no_network(tmp_path):
    (tmp_path / "secret").write_text("another's tree")
    arguments = {"outside": np.frombuffer(str(tmp_path).encode(), np.uint8)}
    found = run_limited(f"{HERE}:try_everything", arguments, Limits(), what="The test")
    managed = {name for name, value in found.items() if int(value)}
    assert managed == {"write_own", "read_system"}
    assert sorted(path.name for path in tmp_path.iterdir()) == ["secret"]


def test_what_is_missing_is_told_in_words():
    assert all(isinstance(line, str) and line for line in missing_here())
