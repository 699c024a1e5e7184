"""The child process returns what the reader returns, and each failure has its own error code."""

import os
import signal
import time

import numpy as np
import pytest
from galewood.sandbox import Arrays, Limits, run_limited
from galewood.tree.importer import read_tree, render_glb
from galewood.tree.sandboxed import import_mesh_sandboxed, pack_tree, unpack_tree
from galewood.util import MeshError

from tests.precompute.fixtures import tree_meshes as make

HERE = "tests.precompute.formats.test_mesh_import_process"


def sleep(_: Arrays) -> Arrays:
    time.sleep(60)
    return {}


def spin(_: Arrays) -> Arrays:
    while True:
        pass


def exhaust_memory(_: Arrays) -> Arrays:
    return {"a": np.ones(1 << 30)}


def killed(_: Arrays) -> Arrays:
    os.kill(os.getpid(), signal.SIGKILL)
    return {}


def crash(_: Arrays) -> Arrays:
    os.kill(os.getpid(), signal.SIGSEGV)
    return {}


def test_child_returns_what_the_reader_returns():
    data = make.glb_bytes(make.y_tree(), make.cards([(1.6, 4.6, 0)]))
    tree, glb = import_mesh_sandboxed(data, "a.glb")
    direct = read_tree(data, "a.glb")
    assert glb == render_glb(direct)
    assert tree.report == direct.report
    assert (tree.wood_vertices_m == direct.wood_vertices_m).all()
    assert render_glb(unpack_tree(pack_tree(direct))) == glb


def test_mesh_errors_are_passed_to_the_parent():
    with pytest.raises(MeshError) as caught:
        import_mesh_sandboxed(b"%PDF-1.7 and more", "a.obj")
    assert (caught.value.reason, caught.value.code) == ("unsupported", "unsupported-type")


@pytest.mark.parametrize(
    ("function", "limits", "code"),
    [
        ("sleep", Limits(wall_s=2.0), "timed-out"),
        ("spin", Limits(cpu_s=2), "cpu-time"),
        ("exhaust_memory", Limits(memory_bytes=2 << 30), "out-of-memory"),
        ("killed", Limits(), "killed"),
        ("crash", Limits(), "crashed"),
    ],
)
def test_each_failure_has_its_own_code(function, limits, code):
    with pytest.raises(MeshError) as caught:
        run_limited(f"{HERE}:{function}", {}, limits, what="The test")
    assert (caught.value.code, caught.value.reason) == (code, "unsuitable")
    assert "The test" in caught.value.title
