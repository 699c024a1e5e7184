"""The small tree's tetrahedra and simulated runs, made once for all files of a test run, by whichever process
runs the first of them.
"""

from __future__ import annotations

import fcntl
import os
from pathlib import Path

import pytest
from galewood.options import ImportRequest
from galewood.solid.tets.meshing import cached_tetrahedra_path, tetrahedralise
from galewood.tree.importer import read_tree

from tests.precompute.tree_meshes import BRANCHES, Surface, cards, glb_bytes, y_tree

TARGET_TETS = 800
SCALE = 3.0
"""Of the small tree: the larger a tree, the slower it sways, and the fewer steps its simulation needs."""


def small_tree_glb(species: str = "") -> bytes:
    """The small tree; the name of its wood may tell a species."""
    wood, leaves = y_tree(), cards([end for _, end in BRANCHES])
    return glb_bytes(
        Surface(SCALE * wood.vertices, wood.faces), Surface(SCALE * leaves.vertices, leaves.faces), species
    )


def cache_with_tets(
    folder: Path,
    tmp_path_factory: pytest.TempPathFactory,
    height_m: float | None = None,
    *,
    share_runs: bool = False,
) -> Path:
    """A build's cache at ``folder`` with the small tree's tetrahedra, of the given height or its own.

    With ``share_runs`` it has the simulated runs of the other caches made with it, and they have its own.
    """
    base = tmp_path_factory.getbasetemp()
    # under xdist every process has a folder of its own below the run's
    shared = (base.parent if os.environ.get("PYTEST_XDIST_WORKER") else base) / "shared-cache"
    folder.mkdir(parents=True)
    for name in ("tets", "models", "trajectories") if share_runs else ("tets",):
        (shared / name).mkdir(parents=True, exist_ok=True)
        (folder / name).symlink_to(shared / name, target_is_directory=True)
    with (shared / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # one meshes, the others wait for it
        tree = read_tree(small_tree_glb(), "tree.glb", ImportRequest(species="maple", height_m=height_m))
        if not cached_tetrahedra_path(tree, TARGET_TETS, shared / "tets").exists():
            tetrahedralise(tree, TARGET_TETS, shared / "tets")
    return folder
