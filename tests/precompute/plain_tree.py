"""The tree that the tests of formats write in many ways, and what every one of them must give."""

import numpy as np
from galewood.options import ImportRequest
from galewood.tree.importer import read_tree

from tests.precompute import tree_meshes as make

TREE = make.y_tree()
HEIGHT_M = float(np.ptp(TREE.vertices[:, 1]))


def wood_of(data: bytes, name="a.glb", options: ImportRequest | None = None):
    tree = read_tree(data, name, options)
    (wood,) = [p for p in tree.primitives if p.kind == "wood"]
    return tree, wood


def assert_same_tree(found, tolerance_m: float) -> None:
    (plain,) = read_tree(make.glb_bytes(TREE), "a.glb").primitives
    assert len(found.faces) == len(TREE.faces)
    ours, theirs = found.positions_m[found.faces], plain.positions_m[plain.faces]
    distance = np.linalg.norm(ours.mean(axis=1)[:, None] - theirs.mean(axis=1)[None], axis=2)
    assert float(distance.min(axis=1).max()) <= tolerance_m
    assert float(distance.min(axis=0).max()) <= tolerance_m
