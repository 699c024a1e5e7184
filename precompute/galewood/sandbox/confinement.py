"""A child process gives up what it does not need before it reads what a stranger sent: files and the network.

Two locks of the Linux kernel, neither of which needs a privilege or a namespace, so that they hold in
containers too. Landlock leaves one folder to write in, and to read the system and our own code; a seccomp
filter leaves no way to open a socket. What a platform lacks is told, not hidden: `confine` returns what could
not be locked, and `python -m galewood.sandbox.confinement` asks a process of its own.
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
X32 = 0x40000000  # a second numbering of the same calls on x86-64
# AUDIT_ARCH_… and, for each machine: socket, socketpair, io_uring_setup (which can open sockets too),
# ptrace, process_vm_writev, bpf, userfaultfd
CALLS = {
    "x86_64": (0xC000003E, (41, 53, 425, 101, 311, 321, 323)),
    "aarch64": (0xC00000B7, (198, 199, 425, 117, 271, 280, 282)),
}


def confine(folder: Path, readable: Iterable[str] = ()) -> list[str]:
    """Give up, for this thread and all it starts, files outside `folder` and opening sockets; `readable` are
    paths that may be read besides the system and our own code.

    To be called before any other thread is started. Returns what could not be given up, in words.
    """
    if not sys.platform.startswith("linux"):
        return [f"files and the network are not confined on {sys.platform}"]
    missing: list[str] = []
    if not _lock_files(folder, readable):
        missing.append("files are not confined: the kernel has no Landlock")
    if not _lock_network():
        missing.append("the network is not closed: the kernel refuses seccomp filters")
    return missing


def _lock_files(folder: Path, readable: Iterable[str]) -> bool:
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


def _lock_network() -> bool:
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
    """Instructions (struct sock_filter): another architecture is killed, the calls fail, the rest runs."""
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
    """What `confine` could not lock on this machine, found out by a process that does not come back."""
    with tempfile.TemporaryDirectory(prefix="galewood-") as folder:
        command = [sys.executable, "-m", "galewood.sandbox.confinement", folder]
        found = subprocess.run(
            command, cwd=PACKAGE.parent, capture_output=True, text=True, timeout=60, check=False
        )
    return json.loads(found.stdout) if found.returncode == 0 else ["a confined process does not run here"]


if __name__ == "__main__":
    print(json.dumps(confine(Path(sys.argv[1]))))
