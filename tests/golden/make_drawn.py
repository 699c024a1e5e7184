"""Write the positions of drawn vertices for the TypeScript tests: ``python -m tests.golden.make_drawn``."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from galewood.solid.skinning import drawn_positions
from galewood.table import decode

from tests.golden import GOLDEN_FOLDER


def drawn_vectors() -> list[dict[str, Any]]:
    """Vertices of the pole at rest and as drawn, in small and large poses, at two factors."""
    table = decode((GOLDEN_FOLDER / "pole-table.safetensors").read_bytes())
    rng = np.random.default_rng(22)
    rest_m = rng.uniform((-0.5, 0.0, -0.5), (0.5, 4.0, 0.5), (len(table.vertex_joint), 3))
    rows: list[dict[str, Any]] = []
    for size, factor in ((0.02, 1.0), (0.3, 1.0), (0.3, 3.0), (2.0, 1.0)):
        q = size * rng.normal(size=len(table.mode_scale))
        drawn = drawn_positions(table, rest_m, q, factor)
        rows.append({"q": q.tolist(), "factor": factor, "rest_m": rest_m.tolist(), "drawn_m": drawn.tolist()})
    return rows


if __name__ == "__main__":
    (GOLDEN_FOLDER / "drawn.json").write_text(json.dumps(drawn_vectors()) + "\n")
