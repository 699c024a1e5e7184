"""Real trees, where a folder of them is given: every one with wood becomes one piece of the wanted size."""

import os
from pathlib import Path

import pytest

from precompute.intake import IntakeError
from precompute.intake_process import run_intake
from precompute.skeleton import extract_skeleton, sampled_elements
from precompute.tetrahedra import tetrahedralise

FOLDER = Path(os.environ.get("CORPUS", ""))
TYPES = (".glb", ".gltf", ".obj", ".ply", ".stl")
FILES = sorted(p for p in FOLDER.rglob("*") if p.suffix in TYPES) if os.environ.get("CORPUS") else []
REFUSED = ("draco-compressed", "meshopt-compressed", "external-buffers")


@pytest.mark.skipif(not FILES, reason="CORPUS names no folder with trees")
@pytest.mark.parametrize("path", FILES, ids=lambda p: p.name)
def test_real_tree(path, tmp_path):
    try:
        tree, _ = run_intake(path.read_bytes(), path.name)
    except IntakeError as error:
        assert error.code in REFUSED  # told by name, never decoded wrongly
        return
    assert 1.0 < tree.height_m < 60.0
    mesh = tetrahedralise(tree, cache_dir=tmp_path)
    assert 3000 <= len(mesh.tets) <= 8000
    assert mesh.report["lost_extent"] <= 0.03
    skeleton = extract_skeleton(mesh)
    assert len(sampled_elements(mesh, skeleton, 435)) == 435
