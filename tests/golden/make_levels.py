"""Write the golden levels of detail for both languages: ``python -m tests.golden.make_levels``.

What is shown of a built-in tree: triangles of every level, and some vertices with the rank of their piece and
where they are drawn at one share.
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from galewood.constants import LEVEL_SHARES
from galewood.io.export.engine.pieces import leaf_pieces, wood_pieces
from galewood.io.export.gltf_file import GltfFile
from galewood.table import decode

from tests.golden import GOLDEN_FOLDER

TREE = "assets/species/shipped/apricot-forest"
SHARE = 0.25
EVERY = 97


def levels() -> dict[str, Any]:
    """The content of the file."""
    base = GOLDEN_FOLDER.parents[1] / TREE
    table = decode(base.with_suffix(".table").read_bytes())
    file = GltfFile(base.with_suffix(".glb").read_bytes(), table)
    splits, parts = np.cumsum(file.counts)[:-1], list[dict[str, Any]]()
    rest = np.split(file.rest_m(), splits)
    for primitive, rest_m, faces in zip(table.metadata["primitives"], rest, file.faces(), strict=True):
        pieces = (leaf_pieces if primitive["kind"] == "leaves" else wood_pieces)(rest_m, faces)
        of, vertices = pieces.of_vertex, np.arange(0, len(rest_m), EVERY)
        size, anchor = pieces.shown(SHARE)[of][:, None], pieces.anchor_m[of]
        parts.append(
            {
                "triangles": [
                    int((pieces.shown(share)[of[faces[:, 0]]] > 0).sum()) for share in LEVEL_SHARES
                ],
                "rank": pieces.rank[of][vertices].round(9).tolist(),
                "drawn_m": (anchor + size * (rest_m - anchor))[vertices].round(6).tolist(),
            }
        )
    return {"tree": TREE, "share": SHARE, "every": EVERY, "parts": parts}


if __name__ == "__main__":
    (GOLDEN_FOLDER / "levels.json").write_text(json.dumps(levels()) + "\n")
