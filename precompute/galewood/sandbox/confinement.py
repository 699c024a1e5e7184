"""A child process drops its access to files and the network before it parses untrusted input.

Two Linux kernel mechanisms are used. Neither needs privileges or namespaces, so both also work in containers.
Landlock restricts writing to one folder and reading to the system and this package; a seccomp filter blocks
the creation of sockets. Missing kernel support is reported rather than ignored: `confine` returns what could
not be restricted, and `python -m galewood.sandbox.confinement` checks it in a separate process.
"""

from __future__ import annotations

import ctypes
import errno
import json
import platform
import struct
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent.parent
SYSTEM = ("/usr", "/lib", "/lib64", "/bin", "/etc", "/proc/self", "/sys")
DEVICES = ("/dev/null", "/dev/zero", "/dev/urandom", "/dev/random")
PR_SET_NO_NEW_PRIVS, PR_SET_SECCOMP, SECCOMP_MODE_FILTER = 38, 22, 2
# classic BPF (linux/bpf_common.h) over struct seccomp_data: nr at offset 0, arch at offset 4
LOAD, EQUAL, AT_LEAST, RETURN = 0x20, 0x15, 0x35, 0x06
ALLOW, KILL, DENY = 0x7FFF0000, 0x80000000, 0x00050000 | errno.EPERM
X32 = 0x40000000  # the x32 ABI numbers the same calls a second time on x86-64
# AUDIT_ARCH_… and, for each machine: socket, socketpair, io_uring_setup (which can open sockets too),
# ptrace, process_vm_writev, bpf, userfaultfd
CALLS = {
    "x86_64": (0xC000003E, (41, 53, 425, 101, 311, 321, 323)),
    "aarch64": (0xC00000B7, (198, 199, 425, 117, 271, 280, 282)),
}


def confine(folder: Path, readable: Iterable[str] = ()) -> list[str]:
    """Restrict this thread and everything it starts to files in `folder`, without sockets.

    `readable` lists paths that may be read in addition to the system and this package. Call it before any
    other thread is started. Returns messages that describe the restrictions that could not be applied.
    """
    if not sys.platform.startswith("linux"):
        return [f"files and network are not confined on {sys.platform}"]
    missing: list[str] = []
    if not _restrict_files(folder, readable):
        missing.append("files are not confined: the kernel has no Landlock")
    if not _restrict_network():
        missing.append("the network is not blocked: the kernel rejects seccomp filters")
    return missing


def _restrict_files(folder: Path, readable: Iterable[str]) -> bool:
    from py_landlock import AccessFs, Landlock, LandlockError

    known = _existing((*SYSTEM, sys.prefix, sys.base_prefix, str(PACKAGE), *readable))
    device = AccessFs.READ_FILE | AccessFs.WRITE_FILE
    try:
        rules = Landlock(strict=False).allow_read(*known).allow_execute(*known).allow_read_write(folder)
        rules.add_path_rule(*_existing(DEVICES), access=device).apply()
    except (LandlockError, OSError):
        return False
    return True


def _existing(paths: Iterable[str]) -> list[Path]:
    return [Path(path) for path in dict.fromkeys(paths) if Path(path).exists()]


def _restrict_network() -> bool:
    if platform.machine() not in CALLS:
        return False
    architecture, calls = CALLS[platform.machine()]
    program = _filter(architecture, calls)
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0:
        return False
    instructions = ctypes.create_string_buffer(program, len(program))

    class Program(ctypes.Structure):
        _fields_ = (("length", ctypes.c_ushort), ("filter", ctypes.c_void_p))

    pointer = ctypes.cast(instructions, ctypes.c_void_p)
    filled = Program(len(program) // 8, pointer)
    return libc.prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, ctypes.byref(filled), 0, 0) == 0


def _filter(architecture: int, denied: tuple[int, ...]) -> bytes:
    """BPF program (array of struct sock_filter) that denies the given system calls with EPERM.

    Calls from another architecture kill the process; all other calls are allowed.
    """
    count = len(denied)
    steps = [
        (LOAD, 0, 0, 4),
        (EQUAL, 1, 0, architecture),
        (RETURN, 0, 0, KILL),
        (LOAD, 0, 0, 0),
        (AT_LEAST, count + 1, 0, X32),
        *((EQUAL, count - k, 0, call) for k, call in enumerate(denied)),
        (RETURN, 0, 0, ALLOW),
        (RETURN, 0, 0, DENY),
    ]
    return b"".join(struct.pack("=HBBI", *step) for step in steps)


def missing_here() -> list[str]:
    """Restrictions that `confine` cannot apply on this machine, determined in a separate process."""
    with tempfile.TemporaryDirectory(prefix="galewood-") as folder:
        command = [sys.executable, "-m", "galewood.sandbox.confinement", folder]
        found = subprocess.run(
            command, cwd=PACKAGE.parent, capture_output=True, text=True, timeout=60, check=False
        )
    return json.loads(found.stdout) if found.returncode == 0 else ["confined processes do not start here"]


if __name__ == "__main__":
    print(json.dumps(confine(Path(sys.argv[1]))))
