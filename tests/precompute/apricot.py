"""The apricot on stored tetrahedra, so that a test of a whole tree needs no mesher."""

from functools import cache
from pathlib import Path

import numpy as np
from galewood.check.verify.specimens import Specimen, read_tree, specimen
from galewood.solid.tets.meshing import TetMesh
from galewood.solid.tets.quality import tet_volumes
from galewood.tree.types import TreeMesh

ROOT = Path(__file__).parents[2]
SPECIES = ROOT / "assets" / "species"


@cache
def tree() -> TreeMesh:
    return read_tree(SPECIES, "apricot")


def stored_mesh(target: int) -> TetMesh:
    """What `tests.golden.make_tets` wrote."""
    with np.load(ROOT / "tests" / "golden" / f"apricot-{target}.npz") as file:
        vertices = file["vertices_m"].astype(np.float64)
        tets, ratio = file["tets"].astype(np.int32), file["radius_ratio"].astype(np.float64)
    assert (tet_volumes(vertices, tets) > 0).all()
    return TetMesh(vertices, tets, ratio, {})


@cache
def apricot(target: int = 5500) -> Specimen:
    return specimen(SPECIES, "apricot", tree(), stored_mesh(target))
