"""The small tree's tetrahedra, meshed once for all files of a test run, whichever process runs them."""

from __future__ import annotations

import fcntl
import os
from pathlib import Path

import pytest
from galewood.mesh.importer import read_tree
from galewood.mesh.types import ImportOptions
from galewood.tets.meshing import tetrahedralise

from tests.precompute.tree_meshes import BRANCHES, cards, glb_bytes, y_tree

TARGET_TETS = 800


def small_tree_glb() -> bytes:
    return glb_bytes(y_tree(), cards([end for _, end in BRANCHES]))


def cache_with_tets(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A build's cache at ``folder`` that has the small tree's tetrahedra already."""
    base = tmp_path_factory.getbasetemp()
    # under xdist every process has a folder of its own below the run's
    shared = (base.parent if os.environ.get("PYTEST_XDIST_WORKER") else base) / "shared-tets"
    shared.mkdir(exist_ok=True)
    folder.mkdir(parents=True)
    (folder / "tets").symlink_to(shared, target_is_directory=True)
    with (shared / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # one meshes, the others wait for it
        if not any(shared.glob("*.npz")):
            tree = read_tree(small_tree_glb(), "tree.glb", ImportOptions(species="maple"))
            tetrahedralise(tree, TARGET_TETS, shared)
    return folder
