"""Operations that are denied to a child that parses untrusted input, where the kernel supports this."""

import os
import socket
from pathlib import Path

import numpy as np
import pytest
from galewood.sandbox.confinement import missing_here
from galewood.sandbox.limited_process import Arrays, Limits, run_limited

HERE = "tests.precompute.test_confinement"


def try_everything(arguments: Arrays) -> Arrays:
    """Attempt each operation: 1 if it succeeds, 0 if it is denied."""
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
    return {name: np.array(_succeeds(attempt)) for name, attempt in attempts.items()}


def _succeeds(attempt) -> int:
    try:
        attempt()
    except OSError:
        return 0
    return 1


@pytest.mark.skipif(bool(missing_here()), reason="this kernel has no Landlock or no seccomp")
def test_child_is_limited_to_its_folder_and_has_no_network(tmp_path):
    (tmp_path / "secret").write_text("another's tree")
    arguments = {"outside": np.frombuffer(str(tmp_path).encode(), np.uint8)}
    found = run_limited(f"{HERE}:try_everything", arguments, Limits(), what="The test")
    succeeded = {name for name, value in found.items() if int(value)}
    assert succeeded == {"write_own", "read_system"}
    assert sorted(path.name for path in tmp_path.iterdir()) == ["secret"]


def test_missing_restrictions_are_described():
    assert all(isinstance(line, str) and line for line in missing_here())
