"""The system calls of a confined process: those listed here, and no others.

A seccomp filter answers all other calls, future ones included, as if the kernel did not have them (ENOSYS):
libraries then do what they do on older kernels. A confined process can therefore neither start processes nor
run programs, has no sockets, and changes no other process and no owner, mode, time or attribute of any file.
Which files it can open is decided by Landlock (confinement.py).
"""

from __future__ import annotations

import ctypes
import errno
import os
import platform
import struct
from dataclasses import dataclass

CLONE_THREAD = 0x00010000
CLONE_NAMESPACES = 0x7E020000  # CLONE_NEWNS, NEWCGROUP, NEWUTS, NEWIPC, NEWUSER, NEWPID, NEWNET
MACHINES = ("x86_64", "aarch64")
"""Machines whose call numbers are known, in the order of the numbers in ALL_CALLS."""
ARCHITECTURES = {"x86_64": 0xC000003E, "aarch64": 0xC00000B7}  # AUDIT_ARCH_… (linux/audit.h)

Numbers = tuple[int | None, int | None]
FILE_CALLS: dict[str, Numbers] = {
    "open": (2, None), "openat": (257, 56), "close": (3, 57), "close_range": (436, 436),
    "read": (0, 63), "readv": (19, 65), "pread64": (17, 67), "preadv": (295, 69),
    "write": (1, 64), "writev": (20, 66), "pwrite64": (18, 68), "pwritev": (296, 70),
    "lseek": (8, 62), "ftruncate": (77, 46), "fallocate": (285, 47), "fadvise64": (221, 223),
    "fsync": (74, 82), "fdatasync": (75, 83), "dup": (32, 23), "dup2": (33, None), "dup3": (292, 24),
    "stat": (4, None), "lstat": (6, None), "fstat": (5, 80), "newfstatat": (262, 79), "statx": (332, 291),
    "statfs": (137, 43), "fstatfs": (138, 44), "access": (21, None), "faccessat": (269, 48),
    "faccessat2": (439, 439), "readlink": (89, None), "readlinkat": (267, 78), "getdents64": (217, 61),
    "getcwd": (79, 17), "umask": (95, 166), "mkdir": (83, None), "mkdirat": (258, 34), "rmdir": (84, None),
    "unlink": (87, None), "unlinkat": (263, 35), "rename": (82, None), "renameat": (264, 38),
    "renameat2": (316, 276), "fcntl": (72, 25), "ioctl": (16, 29),
}  # fmt: skip
MEMORY_CALLS: dict[str, Numbers] = {
    "brk": (12, 214), "mmap": (9, 222), "munmap": (11, 215), "mremap": (25, 216), "mprotect": (10, 226),
    "madvise": (28, 233), "msync": (26, 227), "mincore": (27, 232), "membarrier": (324, 283),
}  # fmt: skip
THREAD_CALLS: dict[str, Numbers] = {
    "clone": (56, 220), "futex": (202, 98), "set_robust_list": (273, 99), "set_tid_address": (218, 96),
    "rseq": (334, 293), "gettid": (186, 178), "sched_yield": (24, 124), "sched_getaffinity": (204, 123),
    "getcpu": (309, 168), "exit": (60, 93), "exit_group": (231, 94), "prctl": (157, 167),
}  # fmt: skip
SIGNAL_CALLS: dict[str, Numbers] = {
    "rt_sigaction": (13, 134), "rt_sigprocmask": (14, 135), "rt_sigreturn": (15, 139),
    "sigaltstack": (131, 132), "restart_syscall": (219, 128), "kill": (62, 129), "tgkill": (234, 131),
}  # fmt: skip
TIME_CALLS: dict[str, Numbers] = {
    "clock_gettime": (228, 113), "clock_getres": (229, 114), "gettimeofday": (96, 169), "time": (201, None),
    "nanosleep": (35, 101), "clock_nanosleep": (230, 115), "poll": (7, None), "ppoll": (271, 73),
    "select": (23, None), "pselect6": (270, 72),
}  # fmt: skip
INFORMATION_CALLS: dict[str, Numbers] = {
    "getpid": (39, 172), "getppid": (110, 173), "getuid": (102, 174), "geteuid": (107, 175),
    "getgid": (104, 176), "getegid": (108, 177), "uname": (63, 160), "sysinfo": (99, 179),
    "times": (100, 153), "getrusage": (98, 165), "getrandom": (318, 278), "prlimit64": (302, 261),
}  # fmt: skip
ALL_CALLS = FILE_CALLS | MEMORY_CALLS | THREAD_CALLS | SIGNAL_CALLS | TIME_CALLS | INFORMATION_CALLS

# classic BPF (linux/bpf_common.h) over struct seccomp_data: call at 0, architecture at 4, arguments at 16
BPF_LOAD, BPF_AND, BPF_EQUAL, BPF_RETURN = 0x20, 0x54, 0x15, 0x06
RET_ALLOW, KILL_PROCESS, RET_ERRNO = 0x7FFF0000, 0x80000000, 0x00050000
PR_SET_NO_NEW_PRIVS, PR_SET_SECCOMP, SECCOMP_MODE_FILTER = 38, 22, 2
Instruction = tuple[int, int, int, int]
"""Operation, instructions to skip if a comparison is true and if it is false, operand: struct sock_filter."""


@dataclass(frozen=True)
class Only:
    """Some bits of one argument of a call must have one of these values; otherwise it fails with EPERM."""

    argument: int
    values: tuple[int, ...]
    bits: int = 0xFFFFFFFF


def conditions(pid: int) -> dict[str, Only]:
    """The calls that the process `pid` may make only with certain arguments."""
    return {
        "clone": Only(0, (CLONE_THREAD,), CLONE_THREAD | CLONE_NAMESPACES),
        "kill": Only(0, (pid,)),
        "tgkill": Only(0, (pid,)),
        "prlimit64": Only(0, (0, pid)),
        "prctl": Only(0, (15, 16, 0x53564D41)),  # names of threads and of memory, not the death signal
        "fcntl": Only(1, (0, 1, 2, 3, 4, 1030)),  # duplicates and flags; not the process that gets signals
        "ioctl": Only(1, (0x5401, 0x5413, 0x541B, 0x5421, 0x5450, 0x5451)),  # not the attributes of files
    }


def restrict_calls() -> bool:
    """Leave this thread, and those that it starts, only the calls listed here; False if that is impossible.

    This holds for the present process: it must not be inherited by a fork.
    """
    machine = platform.machine()
    if machine not in MACHINES:
        return False
    program = b"".join(struct.pack("=HBBI", *step) for step in filter_program(machine, os.getpid()))
    instructions = ctypes.create_string_buffer(program, len(program))

    class Program(ctypes.Structure):
        _fields_ = (("length", ctypes.c_ushort), ("filter", ctypes.c_void_p))

    filled = Program(len(program) // 8, ctypes.cast(instructions, ctypes.c_void_p))
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0:
        return False
    return libc.prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, ctypes.byref(filled), 0, 0) == 0


def filter_program(machine: str, pid: int) -> list[Instruction]:
    """The BPF program for a machine of MACHINES. Calls of another architecture kill the process."""
    only = conditions(pid)
    steps: list[Instruction] = [
        (BPF_LOAD, 0, 0, 4),
        (BPF_EQUAL, 1, 0, ARCHITECTURES[machine]),
        (BPF_RETURN, 0, 0, KILL_PROCESS),
        (BPF_LOAD, 0, 0, 0),
    ]
    for name, numbers in ALL_CALLS.items():
        number = numbers[MACHINES.index(machine)]
        if number is not None:
            answer = _answer(only.get(name))
            steps += [(BPF_EQUAL, 0, len(answer), number), *answer]
    return [*steps, (BPF_RETURN, 0, 0, RET_ERRNO | errno.ENOSYS)]


def _answer(only: Only | None) -> list[Instruction]:
    """The instructions that answer one call."""
    if only is None:
        return [(BPF_RETURN, 0, 0, RET_ALLOW)]
    steps: list[Instruction] = [(BPF_LOAD, 0, 0, 16 + 8 * only.argument), (BPF_AND, 0, 0, only.bits)]
    # the kernel reads the lower half of these arguments, which comes first on little-endian machines
    for value in only.values:
        steps += [(BPF_EQUAL, 0, 1, value), (BPF_RETURN, 0, 0, RET_ALLOW)]
    return [*steps, (BPF_RETURN, 0, 0, RET_ERRNO | errno.EPERM)]
