"""A child process gives up what it does not need before it parses untrusted input.

Three Linux kernel mechanisms are used. None needs privileges or namespaces, so all also work in containers.
Landlock restricts writing to one folder and reading to the libraries and this package; a seccomp filter
leaves only the system calls that computing needs (system_calls.py); a child of root drops its capabilities.
Missing kernel support is reported rather than ignored: `confine` returns what could not be restricted, and
`python -m galewood.sandbox.confinement` checks it in a separate process.
"""

from __future__ import annotations

import ctypes
import json
import mimetypes
import os
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path

from galewood.sandbox.system_calls import restrict_calls
from galewood.threads import SINGLE_THREADED
from galewood.util import GuardedProcess

PACKAGE = Path(__file__).resolve().parent.parent
LIBRARIES = ("/usr", "/lib", "/lib64", "/etc/ld.so.cache")
SETTINGS = ("/etc/localtime", "/etc/ssl/openssl.cnf", *map(str, mimetypes.knownfiles))
"""What standard libraries read if it is there; the rest of /etc may hold secrets."""
MACHINE_FILES = ("/proc/self", "/proc/cpuinfo", "/sys/devices/system/cpu")
DEVICES = ("/dev/null", "/dev/zero", "/dev/urandom", "/dev/random")
CAPABILITY_VERSION = 0x20080522  # linux/capability.h
CHECK_S = 300.0
"""After which a process that only confines itself counts as hanging, s."""
MISSING_FILE = "missing.json"


def confine(folder: Path, readable: Iterable[str] = ()) -> list[str]:
    """Restrict this process to files in `folder` and to the calls of system_calls.py.

    `readable` lists paths that may be read in addition to the libraries and this package. Returns messages
    that describe the restrictions that could not be applied. Raises RuntimeError if the process has other
    threads, which would keep their rights.
    """
    if not sys.platform.startswith("linux"):
        return [f"files, processes and network are not confined on {sys.platform}"]
    if _count_threads() > 1:
        raise RuntimeError("a process with several threads cannot be confined")
    missing: list[str] = []
    if not _restrict_files(folder, readable):
        missing.append("files are not confined: the kernel has no Landlock")
    if not _drop_capabilities():
        missing.append("root privileges are not dropped")
    if not restrict_calls():
        missing.append("processes and the network are not blocked: the kernel rejects seccomp filters")
    return missing


def _count_threads() -> int:
    return len(list(Path("/proc/self/task").iterdir()))


def _restrict_files(folder: Path, readable: Iterable[str]) -> bool:
    from py_landlock import AccessFs, Landlock, LandlockError

    packages = [path for path in sys.path if Path(path).name in ("site-packages", "dist-packages")]
    python = (sys.prefix, sys.base_prefix, *packages, str(PACKAGE))
    known = _existing((*LIBRARIES, *SETTINGS, *MACHINE_FILES, *python, *readable))
    folders = [folder, *(path for path in known if path.is_dir())]
    files = [path for path in known if not path.is_dir()]
    # No links: the parent reads the results with its own rights. Nor sockets, pipes or devices.
    content = AccessFs.WRITE_FILE | AccessFs.TRUNCATE | AccessFs.MAKE_REG | AccessFs.REMOVE_FILE
    own = content | AccessFs.MAKE_DIR | AccessFs.REMOVE_DIR
    device = AccessFs.READ_FILE | AccessFs.WRITE_FILE
    try:
        rules = Landlock(strict=False).allow_read(*folders).add_path_rule(folder, access=own)
        rules.add_path_rule(*files, access=AccessFs.READ_FILE)
        rules.add_path_rule(*_existing(DEVICES), access=device).apply()
    except (LandlockError, OSError):
        return False
    return True


def _existing(paths: Iterable[str]) -> list[Path]:
    return [Path(path) for path in dict.fromkeys(paths) if Path(path).exists()]


def _drop_capabilities() -> bool:
    """Give up all capabilities (capabilities(7)); without capabilities there is nothing to do."""
    head = (ctypes.c_uint32 * 2)(CAPABILITY_VERSION, 0)
    return ctypes.CDLL(None, use_errno=True).capset(head, (ctypes.c_uint32 * 6)()) == 0


def unavailable_restrictions() -> list[str]:
    """Restrictions that `confine` cannot apply on this machine, determined in a separate process."""
    with tempfile.TemporaryDirectory(prefix="galewood-") as folder, tempfile.TemporaryFile() as errors:
        program = [sys.executable, "-m", "galewood.sandbox.confinement", folder]
        environment = os.environ | SINGLE_THREADED
        with GuardedProcess(program, cwd=PACKAGE.parent, environment=environment, errors=errors) as child:
            if child.wait(CHECK_S) != 0:
                return ["confined processes do not start here"]
        return json.loads(Path(folder, MISSING_FILE).read_text())


if __name__ == "__main__":
    Path(sys.argv[1], MISSING_FILE).write_text(json.dumps(confine(Path(sys.argv[1]))))
