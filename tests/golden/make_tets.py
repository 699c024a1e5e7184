"""Write the tetrahedra of the apricot for the tests: meshing takes minutes and is not deterministic.

`python -m tests.golden.make_tets` meshes it with three target counts (cached in data/cache).
"""

from pathlib import Path

import numpy as np
from galewood.check.verify.specimens import TARGETS, cached_mesher, read_tree

HERE = Path(__file__).parent
SPECIES = HERE.parents[1] / "assets" / "species"


def write(folder: Path = HERE, cache_dir: Path = Path("data/cache")) -> None:
    tree, mesher = read_tree(SPECIES, "apricot"), cached_mesher(cache_dir)
    for target in TARGETS:
        mesh = mesher("apricot", tree, target)
        np.savez_compressed(
            folder / f"apricot-{target}.npz",
            vertices_m=mesh.vertices_m.astype(np.float32),
            tets=mesh.tets.astype(np.uint16),
            radius_ratio=mesh.radius_ratio.astype(np.float32),
        )


if __name__ == "__main__":
    write()
