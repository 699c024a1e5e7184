"""Writes vertex animation textures and where the table draws the vertices: ... write_exports FOLDER

vat/: the export, as `galewood export --to vat` writes it; expected.json: a moment between two frames, the
height, and the vertices at rest and at that moment, with the centres of their texels (TEXCOORD_1).
"""

import json
import sys
from pathlib import Path

import numpy as np
from galewood.io.export import ExportOptions, write_export
from galewood.io.export.looped import looped
from galewood.motion.wind import Wind
from galewood.solid.skinning import drawn_positions
from galewood.table import decode

from tests.precompute.fixtures.gltf_reading import Glb

SHIPPED = Path("assets/species/shipped/apricot-forest.table")
OPTIONS = ExportOptions(wind=Wind(mean_speed_m_s=10.0), seconds=2.0, fps=12.0)
TIME_S = 1.03


def main(folder: Path) -> None:
    """Write both into the folder."""
    table, mesh = decode(SHIPPED.read_bytes()), SHIPPED.with_suffix(".glb").read_bytes()
    write_export(table, mesh, "vat", folder / "vat", "tree", OPTIONS)
    glb = Glb(folder / "vat/tree.glb")
    rest = glb.attribute("POSITION").astype(np.float64)
    drawn = drawn_positions(table, rest, looped(table, OPTIONS.wind, 2.0, 12.0).q_at(TIME_S))
    expected = {
        "time_s": TIME_S,
        "height_m": float(table.metadata["height_m"]),
        "rest": rest.ravel().tolist(),
        "texel": glb.attribute("TEXCOORD_1").astype(np.float64).ravel().tolist(),
        "drawn": drawn.ravel().tolist(),
    }
    (folder / "expected.json").write_text(json.dumps(expected))


main(Path(sys.argv[1]))
