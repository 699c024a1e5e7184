"""What hostile code in a confined child could try: a table of small functions that succeed or raise OSError.

``python -m tests.precompute.sandbox.confinement_probes SCENE`` runs them without confinement, in a
process that ends afterwards, and prints the outcomes.
"""

import ctypes
import errno
import fcntl
import json
import os
import platform
import resource
import signal
import socket
import struct
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from galewood.sandbox import Arrays

LIBC = ctypes.CDLL(None, use_errno=True)
DONE = "done"
NUMBERS: dict[str, tuple[int, int]] = {  # x86_64, aarch64
    "add_key": (248, 217), "bpf": (321, 280), "chroot": (161, 51), "clone": (56, 220), "clone3": (435, 435),
    "execve": (59, 221), "execveat": (322, 281), "fanotify_init": (300, 262), "fchmodat": (268, 53),
    "fsopen": (430, 430), "io_uring_setup": (425, 425), "ioprio_set": (251, 30), "kcmp": (312, 272),
    "keyctl": (250, 219), "memfd_create": (319, 279), "migrate_pages": (256, 238), "mount": (165, 40),
    "move_pages": (279, 239), "mq_open": (240, 180), "msgget": (68, 186), "open_tree": (428, 428),
    "perf_event_open": (298, 241), "personality": (135, 92), "pidfd_open": (434, 434),
    "pivot_root": (155, 41), "prlimit64": (302, 261), "process_vm_readv": (310, 270),
    "process_vm_writev": (311, 271), "ptrace": (101, 117), "request_key": (249, 218),
    "rt_sigqueueinfo": (129, 138), "sched_setattr": (314, 274), "sched_setparam": (142, 118),
    "semget": (64, 190), "setns": (308, 268), "shmget": (29, 194), "tkill": (200, 130),
    "umount2": (166, 39), "unshare": (272, 97), "userfaultfd": (323, 282),
}  # fmt: skip


@dataclass(frozen=True)
class Scene:
    """A process of the same user, and a folder of the user with the files "secret" and "spare"."""

    victim: int
    outside: Path


Probe = Callable[[Scene], object]


def call(name: str, *arguments: int) -> int:
    """A system call; OSError if it fails."""
    number = NUMBERS[name][("x86_64", "aarch64").index(platform.machine())]
    result = LIBC.syscall(ctypes.c_long(number), *(ctypes.c_long(value) for value in arguments))
    if result < 0:
        raise OSError(ctypes.get_errno(), name)
    return result


def address(content: bytes) -> int:
    """Where a copy of the bytes is; it is kept until the process ends."""
    KEPT.append(ctypes.create_string_buffer(content, len(content) + 64))
    return ctypes.addressof(KEPT[-1])


KEPT: list[ctypes.Array[ctypes.c_char]] = []


def checked(result: int) -> None:
    """OSError if a function of the C library has failed."""
    if result < 0:
        raise OSError(ctypes.get_errno(), "refused")


def raw_clone(flags: int) -> None:
    """A new process, which ends at once."""
    if call("clone", flags | signal.SIGCHLD, 0, 0, 0, 0) == 0:
        os._exit(0)


def clone3() -> None:
    """As above, with the newer call."""
    arguments = struct.pack("=8Q", 0, 0, 0, 0, signal.SIGCHLD, 0, 0, 0)
    if call("clone3", address(arguments), len(arguments)) == 0:
        os._exit(0)


def fork() -> None:
    """As the C library does it."""
    if os.fork() == 0:
        os._exit(0)


def spawn(program: str) -> None:
    """Run a program."""
    os.waitpid(os.posix_spawn(program, [program, "-c", "exit 0"], {}), 0)


def seek_memory(pid: int) -> None:
    """Open the memory of a process."""
    os.close(os.open(f"/proc/{pid}/mem", os.O_RDWR))


def signal_by_pipe(scene: Scene) -> None:
    """Let the kernel send a signal to another process when a pipe becomes readable."""
    with tempfile.TemporaryFile(dir=".") as file:
        fcntl.fcntl(file, fcntl.F_SETOWN, scene.victim)


def nice_other(scene: Scene) -> None:
    """Change the priority of a process."""
    os.setpriority(os.PRIO_PROCESS, scene.victim, os.getpriority(os.PRIO_PROCESS, scene.victim) + 1)


def limit_other(scene: Scene) -> None:
    """Limit the files that a process may open."""
    call("prlimit64", scene.victim, resource.RLIMIT_NOFILE, address(struct.pack("=2Q", 50, 50)), 0)


def bind_other(scene: Scene) -> None:
    """Bind a process to one processor."""
    os.sched_setaffinity(scene.victim, {min(os.sched_getaffinity(scene.victim))})


def schedule_other(scene: Scene) -> None:
    """Give a process another scheduler."""
    os.sched_setscheduler(scene.victim, os.SCHED_BATCH, os.sched_param(0))


def own_file(name: str) -> str:
    """A file of the child's own folder."""
    Path(name).write_text("x")
    return name


def attributes_of(name: str) -> None:
    """Set the attributes of a file (chattr(1)) that may be on a file system without them."""
    get, change = 0x80086601, 0x40086602
    with Path(own_file(name)).open() as file:
        flags = bytearray(fcntl.ioctl(file, get, bytes(8)))
        flags[0] |= 0x40  # without backup
        fcntl.ioctl(file, change, bytes(flags))


def into(scene: Scene, name: str) -> str:
    """A path in the folder outside."""
    return str(scene.outside / name)


def unlimited_memory(_: Scene) -> None:
    """Raise the limit of memory."""
    limit = struct.pack("=2Q", 2**64 - 1, 2**64 - 1)
    call("prlimit64", 0, resource.RLIMIT_AS, address(limit), 0)


def capabilities(_: Scene) -> None:
    """Have any capability."""
    fields = dict(line.split(":\t") for line in Path("/proc/self/status").read_text().splitlines())
    if int(fields["CapEff"], 16) == 0:
        raise PermissionError(errno.EPERM, "no capabilities")


def set_option(option: int, value: int) -> None:
    """An option of this process (prctl(2))."""
    checked(LIBC.prctl(option, value, 0, 0, 0))


def set_attribute(path: str) -> None:
    """An extended attribute of a file."""
    os.setxattr(path, "user.galewood", b"x")


def as_user(path: str) -> None:
    """Give a file to the user who has it already."""
    os.chown(path, os.getuid(), os.getgid())


PROCESSES: dict[str, Probe] = {
    "fork": lambda _: fork(),
    "clone": lambda _: raw_clone(0),
    "clone3": lambda _: clone3(),
    "clone with a new user namespace": lambda _: raw_clone(0x10000000),
    "run a shell": lambda _: spawn("/bin/sh"),
    "execve": lambda _: call("execve", 1, 0, 0),
    "execveat": lambda _: call("execveat", -1, 1, 0, 0, 0),
}
OTHER_PROCESSES: dict[str, Probe] = {
    "prlimit of another": limit_other,
    "sched_setaffinity of another": bind_other,
    "sched_setscheduler of another": schedule_other,
    "sched_setparam of another": lambda scene: call("sched_setparam", scene.victim, address(bytes(4))),
    "sched_setattr of another": lambda scene: call(
        "sched_setattr", scene.victim, address(struct.pack("=2IQiI3Q", 48, 0, 0, 0, 0, 0, 0, 0)), 0
    ),
    "setpriority of another": nice_other,
    "setpriority of the parent": lambda _: os.setpriority(
        os.PRIO_PROCESS, os.getppid(), os.getpriority(os.PRIO_PROCESS, os.getppid())
    ),
    "ioprio_set of another": lambda scene: call("ioprio_set", 1, scene.victim, 3 << 13),
    "kill another": lambda scene: os.kill(scene.victim, 0),
    "kill the parent": lambda _: os.kill(os.getppid(), 0),
    "kill all": lambda _: os.kill(-1, 0),
    "kill the group": lambda _: os.kill(0, 0),
    "tkill": lambda scene: call("tkill", scene.victim, 0),
    "rt_sigqueueinfo": lambda scene: call(
        "rt_sigqueueinfo", scene.victim, signal.SIGCONT, address(struct.pack("=3i", signal.SIGCONT, 0, -1))
    ),
    "signals by F_SETOWN": signal_by_pipe,
    "pidfd_open": lambda scene: call("pidfd_open", scene.victim, 0),
    "ptrace": lambda scene: call("ptrace", 0x4206, scene.victim, 0, 0),
    "process_vm_readv": lambda scene: call("process_vm_readv", scene.victim, 0, 0, 0, 0, 0),
    "process_vm_writev": lambda scene: call("process_vm_writev", scene.victim, 0, 0, 0, 0, 0),
    "kcmp": lambda scene: call("kcmp", os.getpid(), scene.victim, 1, 0, 0),
    "migrate_pages": lambda scene: call("migrate_pages", scene.victim, 0, 0, 0),
    "move_pages": lambda scene: call("move_pages", scene.victim, 0, 0, 0, 0, 0),
    "environment of another": lambda scene: Path(f"/proc/{scene.victim}/environ").read_bytes(),
    "environment of the parent": lambda _: Path(f"/proc/{os.getppid()}/environ").read_bytes(),
    "memory of another": lambda scene: seek_memory(scene.victim),
    "command of another": lambda scene: Path(f"/proc/{scene.victim}/cmdline").read_bytes(),
    "list of processes": lambda _: list(Path("/proc").iterdir()),
    "outlive the parent": lambda _: set_option(1, 0),
    "adopt processes": lambda _: set_option(36, 1),
}
FILES: dict[str, Probe] = {
    "read outside": lambda scene: (scene.outside / "secret").read_text(),
    "read the accounts": lambda _: Path("/etc/passwd").read_bytes(),
    "list outside": lambda scene: list(scene.outside.iterdir()),
    "write outside": lambda scene: (scene.outside / "secret").write_text("x"),
    "create outside": lambda scene: (scene.outside / "new").write_text("x"),
    "truncate outside": lambda scene: os.truncate(into(scene, "spare"), 0),
    "mkdir outside": lambda scene: (scene.outside / "folder").mkdir(),
    "rename outside": lambda scene: (scene.outside / "spare").rename(scene.outside / "moved"),
    "chmod outside": lambda scene: (scene.outside / "secret").chmod(0o666),
    "fchmodat outside": lambda scene: call(
        "fchmodat", -100, address(bytes(scene.outside / "secret") + b"\0"), 0o666
    ),
    "fchmod": lambda _: os.fchmod(os.open(own_file("mode"), os.O_RDONLY), 0o666),
    "chown outside": lambda scene: as_user(into(scene, "secret")),
    "lchown outside": lambda scene: os.lchown(into(scene, "secret"), os.getuid(), os.getgid()),
    "utime outside": lambda scene: os.utime(into(scene, "secret"), (1, 1)),
    "futimens": lambda _: os.utime(os.open(own_file("time"), os.O_RDONLY), (1, 1)),
    "setxattr outside": lambda scene: set_attribute(into(scene, "secret")),
    "removexattr outside": lambda scene: os.removexattr(into(scene, "attributed"), "user.given"),
    "attributes by ioctl": lambda _: attributes_of("flags"),
    "symlink": lambda scene: Path("symlink").symlink_to(scene.outside / "secret"),
    "link to a file outside": lambda scene: Path("link").hardlink_to(scene.outside / "secret"),
    "link outside": lambda scene: (scene.outside / "link").hardlink_to(own_file("linked")),
    "mkfifo": lambda _: os.mkfifo("fifo"),
    "chroot": lambda _: call("chroot", address(b"/\0")),
    "memfd_create": lambda _: call("memfd_create", address(b"x\0"), 0),
    "fanotify_init": lambda _: call("fanotify_init", 0x200, 0),
}
KERNEL: dict[str, Probe] = {
    "unshare the user": lambda _: call("unshare", 0x10000000),
    "unshare the mounts": lambda _: call("unshare", 0x00020000),
    "setns": lambda _: call("setns", -1, 0),
    "mount": lambda _: call("mount", 0, 1, 0, 0, 0),
    "umount2": lambda _: call("umount2", 1, 0),
    "pivot_root": lambda _: call("pivot_root", 1, 1),
    "open_tree": lambda _: call("open_tree", -100, address(b"/\0"), 0),
    "fsopen": lambda _: call("fsopen", address(b"tmpfs\0"), 0),
    "keyctl": lambda _: call("keyctl", 0, -3, 1),
    "add_key": lambda _: call("add_key", address(b"user\0"), address(b"galewood\0"), address(b"x"), 1, -2),
    "request_key": lambda _: call("request_key", address(b"user\0"), address(b"galewood\0"), 0, -2),
    "SysV memory": lambda _: call("shmget", 0, 4096, 0o1600),
    "SysV semaphores": lambda _: call("semget", 0, 1, 0o1600),
    "SysV messages": lambda _: call("msgget", 0, 0o1600),
    "POSIX messages": lambda _: call("mq_open", address(b"galewood-probe\0"), 0o102, 0o600, 0),
    "perf_event_open": lambda _: call("perf_event_open", 1, 0, -1, -1, 0),
    "bpf": lambda _: call("bpf", 0, 1, 0),
    "userfaultfd": lambda _: call("userfaultfd", 1),
    "io_uring": lambda _: call("io_uring_setup", 1, address(bytes(120))),
    "personality": lambda _: call("personality", 0xFFFFFFFF),
    "TCP socket": lambda _: socket.socket().close(),
    "UDP socket": lambda _: socket.socket(socket.AF_INET, socket.SOCK_DGRAM).close(),
    "Unix socket": lambda _: socket.socket(socket.AF_UNIX).close(),
    "netlink socket": lambda _: socket.socket(socket.AF_NETLINK, socket.SOCK_RAW).close(),
    "socketpair": lambda _: socket.socketpair(),
    "raise the limit of memory": unlimited_memory,
    "capabilities": capabilities,
}
PROBES = PROCESSES | OTHER_PROCESSES | FILES | KERNEL


def outcomes(scene: Scene) -> dict[str, str]:
    """DONE for each probe that succeeds, otherwise the name of its error."""
    found: dict[str, str] = {}
    for name, probe in PROBES.items():
        try:
            probe(scene)
        except OSError as error:
            found[name] = errno.errorcode.get(error.errno or 0, str(error))
        else:
            found[name] = DONE
    return found


def in_child(arguments: Arrays) -> Arrays:
    """Entry point of the confined child."""
    scene = Scene(int(arguments["victim"]), Path(arguments["outside"].tobytes().decode()))
    return {"found": np.frombuffer(json.dumps(outcomes(scene)).encode(), np.uint8)}


if __name__ == "__main__":
    print(json.dumps(outcomes(Scene(int(sys.argv[1]), Path(sys.argv[2])))))
