"""Operations that are denied to a child that parses untrusted input, where the kernel supports this."""

import errno
import io
import json
import os
import resource
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from galewood.sandbox import Arrays, Limits, confinement, run_limited, system_calls
from galewood.sandbox.confinement import unavailable_restrictions
from galewood.tree.importer import read_tree
from PIL import Image

from tests.precompute.fixtures import cylinder_models
from tests.precompute.fixtures import tree_meshes as make
from tests.precompute.fixtures.fbx_files import fbx_bytes
from tests.precompute.fixtures.gltf_files import GltfFile, Json, ktx2, leaf_image
from tests.precompute.fixtures.hostile_files import KTX2, textured, zipped
from tests.precompute.sandbox import confinement_probes
from tests.precompute.sandbox.confinement_probes import DONE, PROBES, Scene

HERE = "tests.precompute.sandbox.test_confinement"
DENIED = {"EPERM", "EACCES", "ENOSYS", "EXDEV"}
REACHED = {"EFAULT", "EBADF", "EINVAL", "ENOKEY", "ENOENT", "ESRCH", "E2BIG"}
"""Errors of calls that the kernel has begun: these probes have arguments that do no harm."""
confined = pytest.mark.skipif(
    bool(unavailable_restrictions()), reason="this kernel has no Landlock or no seccomp"
)


@pytest.fixture
def scene(tmp_path: Path) -> Iterator[Scene]:
    """A process and files of the same user, which a child must leave as they are."""
    outside = tmp_path / "outside"
    outside.mkdir()
    for name in ("secret", "spare", "attributed"):
        (outside / name).write_text("another's tree")
        (outside / name).chmod(0o600)
    with suppress(OSError):  # a file system without attributes
        os.setxattr(outside / "attributed", "user.given", b"x")
    command = [sys.executable, "-c", "print(flush=True); input()"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as victim:
        assert victim.stdout is not None
        victim.stdout.readline()
        yield Scene(victim.pid, outside)
        victim.kill()


def state_of(scene: Scene) -> list[object]:
    """What the probes try to change."""
    files = sorted(scene.outside.iterdir())
    status = [path.stat() for path in files]
    return [
        [path.name for path in files],
        [path.read_text() for path in files],
        [(one.st_mode, one.st_uid, one.st_mtime_ns, one.st_ctime_ns, one.st_nlink) for one in status],
        os.sched_getaffinity(scene.victim),
        os.sched_getscheduler(scene.victim),
        os.getpriority(os.PRIO_PROCESS, scene.victim),
        resource.prlimit(scene.victim, resource.RLIMIT_NOFILE),
    ]


def confined_outcomes(scene: Scene) -> dict[str, str]:
    arguments = {
        "victim": np.array(scene.victim),
        "outside": np.frombuffer(str(scene.outside).encode(), np.uint8),
    }
    found = run_limited(f"{confinement_probes.__name__}:in_child", arguments, Limits(), what="The test")
    return json.loads(found["found"].tobytes())


@confined
def test_no_probe_succeeds_in_a_confined_child(scene):
    before = state_of(scene)
    found = confined_outcomes(scene)
    assert {name: result for name, result in found.items() if result not in DENIED} == {}
    assert found.keys() == PROBES.keys()
    assert state_of(scene) == before


@pytest.mark.skipif(sys.platform != "linux", reason="the probes are of Linux")
def test_probes_succeed_or_reach_the_kernel_without_confinement(scene, tmp_path):
    """Otherwise the test above would show nothing. A user may lack some rights, but not most."""
    command = [sys.executable, "-m", confinement_probes.__name__, str(scene.victim), str(scene.outside)]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    shown = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, check=True)
    found = json.loads(shown.stdout)
    refused = {name: result for name, result in found.items() if result not in {DONE, *REACHED}}
    assert set(refused.values()) <= DENIED | {"EOPNOTSUPP", "ENOTTY"}
    always = (
        "fork", "clone", "run a shell", "execve", "prlimit of another", "sched_setaffinity of another",
        "setpriority of another", "kill another", "signals by F_SETOWN", "chmod outside", "chown outside",
        "utime outside", "symlink", "mkfifo", "memfd_create", "TCP socket", "socketpair",
        "outlive the parent", "environment of the parent", "truncate outside", "list of processes",
    )  # fmt: skip
    print(len(PROBES), "probes; refused:", refused)
    assert not refused.keys() & set(always)
    assert len(refused) < len(PROBES) / 3


def use_own_rights(_: Arrays) -> Arrays:
    """What a parser needs: files in its folder, libraries, threads, its own process."""
    Path("folder").mkdir()
    Path("folder", "own").write_text("x")
    Path("folder", "own").rename("folder/renamed")
    Path("folder", "renamed").unlink()
    Path("folder").rmdir()
    Path(os.__file__).read_bytes()
    Path("/proc/self/status").read_text()
    done = threading.Event()
    thread = threading.Thread(target=done.set)
    thread.start()
    thread.join()
    os.kill(os.getpid(), 0)
    resource.setrlimit(resource.RLIMIT_CPU, resource.getrlimit(resource.RLIMIT_CPU))
    return {"done": np.array(done.is_set())}


def test_a_confined_child_keeps_what_a_parser_needs():
    assert run_limited(f"{HERE}:use_own_rights", {}, Limits(), what="The test")["done"]


def read_each(arguments: Arrays) -> Arrays:
    """Faces of the wood in each file."""
    return {
        name: np.array(len(read_tree(data.tobytes(), name).wood_faces)) for name, data in arguments.items()
    }


def large_webp() -> bytes:
    """The decoder uses a second thread from 512 pixels on."""
    pixels = np.random.default_rng(3).integers(0, 255, (1024, 1024, 3), dtype=np.uint8)
    stream = io.BytesIO()
    Image.fromarray(pixels).save(stream, "webp", quality=30)
    return stream.getvalue()


def test_every_reader_works_in_a_confined_child():
    """Readers with native code, temporary files or threads."""
    wood = make.y_tree()

    def compressed(primitive_of: Callable[[GltfFile], Json]) -> bytes:
        file = GltfFile()
        file.node(mesh=file.mesh(primitive_of(file)))
        return file.bytes()

    files = {
        "draco.glb": compressed(lambda file: file.draco(wood)),
        "meshopt.glb": compressed(lambda file: file.meshopt(wood)),
        "ktx2.glb": textured(ktx2((10, 200, 20, 255)), *KTX2),
        "webp.glb": textured(large_webp(), "image/webp", "EXT_texture_webp"),
        "png.glb": textured(leaf_image("png")),
        "tree.fbx": fbx_bytes({"bark": (wood, (0.4, 0.3, 0.2))}),
        "tree.zip": zipped({"tree.obj": make.obj_bytes(wood)}),
        "tree.ply": make.ply_bytes(wood),
        "tree.stl": make.stl_bytes(wood),
        "oak.mat": cylinder_models.treeqsm(cylinder_models.y_model()),
    }
    arguments = {name: np.frombuffer(data, np.uint8) for name, data in files.items()}
    found = run_limited(f"{HERE}:read_each", arguments, Limits(), what="The test")
    assert {name for name, faces in found.items() if int(faces) > 0} == set(files)


def limits_of_child(_: Arrays) -> Arrays:
    return {
        name: np.array(resource.getrlimit(getattr(resource, f"RLIMIT_{name}")))
        for name in ("CORE", "FSIZE", "NOFILE", "MEMLOCK", "MSGQUEUE", "NPROC")
    }


@pytest.mark.skipif(sys.platform != "linux", reason="some limits are of Linux")
def test_limits_of_a_child_are_final_and_low():
    found = run_limited(f"{HERE}:limits_of_child", {}, Limits(), what="The test")
    for soft, hard in found.values():
        assert soft == hard != resource.RLIM_INFINITY
    assert [int(found[name][0]) for name in ("CORE", "MEMLOCK", "MSGQUEUE")] == [0, 0, 0]
    assert found["FSIZE"][0] < 4 << 30
    assert found["NOFILE"][0] <= 256


def test_a_process_with_other_threads_is_not_confined_in_part(tmp_path):
    """Landlock and seccomp hold for one thread and those that it starts."""
    script = f"""
import sys, threading
from pathlib import Path
from galewood.sandbox.confinement import confine
end = threading.Event()
threading.Thread(target=end.wait).start()
try:
    confine(Path({str(tmp_path)!r}))
except RuntimeError as error:
    print(error)
end.set()
"""
    if sys.platform != "linux":
        pytest.skip("only Linux confines processes")
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path), "OPENBLAS_NUM_THREADS": "1"}
    command = [sys.executable, "-c", script]
    shown = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert "several threads" in shown.stdout


def test_missing_restrictions_are_described():
    assert all(isinstance(line, str) and line for line in unavailable_restrictions())


def test_each_restriction_that_fails_is_named(tmp_path, monkeypatch):
    if sys.platform != "linux":
        pytest.skip("only Linux confines processes")
    monkeypatch.setattr(confinement, "_count_threads", lambda: 1)
    for step in ("_restrict_files", "_drop_capabilities", "restrict_calls"):
        monkeypatch.setattr(confinement, step, lambda *_: False)
    named = confinement.confine(tmp_path)
    assert len(named) == len(set(named)) == 3


PID = 4711
ENOSYS, EPERM = (system_calls.RET_ERRNO | number for number in (errno.ENOSYS, errno.EPERM))


def answer(machine: str, number: int, *arguments: int, architecture: int | None = None) -> int:
    """What the filter answers to a call: an interpreter of the BPF instructions that it uses."""
    values = {0: number, 4: architecture or system_calls.ARCHITECTURES[machine]}
    values |= {16 + 8 * k: value & 0xFFFFFFFF for k, value in enumerate(arguments)}
    program, at, held = system_calls.filter_program(machine, PID), 0, 0
    while True:
        operation, if_true, if_false, operand = program[at]
        at += 1
        if operation == system_calls.BPF_RETURN:
            return operand
        if operation == system_calls.BPF_LOAD:
            held = values.get(operand, 0)
        elif operation == system_calls.BPF_AND:
            held &= operand
        else:
            assert operation == system_calls.BPF_EQUAL
            at += if_true if held == operand else if_false


@pytest.mark.parametrize("machine", system_calls.MACHINES)
def test_the_filter_allows_the_listed_calls_alone(machine):
    column = system_calls.MACHINES.index(machine)
    listed = [numbers[column] for numbers in system_calls.ALL_CALLS.values() if numbers[column] is not None]
    assert len(listed) == len(set(listed))
    conditional = {system_calls.ALL_CALLS[name][column] for name in system_calls.conditions(PID)}
    for number in range(1024):
        expected = system_calls.RET_ALLOW if number in listed else ENOSYS
        if number not in conditional:
            assert answer(machine, number, 1 << 20, 1 << 20) == expected
    assert answer(machine, 0x40000000 | 1) == ENOSYS  # the x32 numbers of x86-64
    assert answer(machine, 1, architecture=0x40000003) == system_calls.KILL_PROCESS  # 32-bit calls


@pytest.mark.parametrize("machine", system_calls.MACHINES)
def test_the_filter_checks_arguments(machine):
    def result(name: str, *arguments: int) -> int:
        number = system_calls.ALL_CALLS[name][system_calls.MACHINES.index(machine)]
        assert number is not None
        return answer(machine, number, *arguments)

    allowed = system_calls.RET_ALLOW
    assert result("clone", 0x3D0F00) == allowed  # pthread_create
    assert result("clone", 0x11) == result("clone", 0x10010000) == EPERM
    assert result("kill", PID, 9) == result("tgkill", PID, 1, 6) == allowed
    assert {result("kill", other, 9) for other in (0, 1, -1, -PID)} == {EPERM}
    assert result("prlimit64", 0, 7) == result("prlimit64", PID, 7) == allowed
    assert result("prlimit64", 1, 7) == EPERM
    assert result("fcntl", 3, 2) == allowed
    assert result("fcntl", 3, 8) == EPERM  # F_SETOWN
    assert result("ioctl", 3, 0x5401) == allowed
    assert result("ioctl", 3, 0x40086602) == EPERM  # FS_IOC_SETFLAGS
    assert result("prctl", 15) == allowed
    assert result("prctl", 1, 0) == EPERM  # PR_SET_PDEATHSIG
