"""The loops of exported GLBs in PlayCanvas: it moves every vertex to where the table draws it."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from galewood.io.export import ExportOptions, write_export
from galewood.io.export.gltf_file import GltfFile
from galewood.io.export.looped import looped
from galewood.motion.wind import PRESETS, Wind
from galewood.solid.skinning import drawn_positions, vertex_rows
from galewood.table import decode

REPOSITORY = Path(__file__).parents[4]
SHIPPED = REPOSITORY / "assets/species/shipped/apricot-forest.table"
PLAYER = Path(__file__).with_name("playcanvasLoop.mjs")
SECONDS, FPS = 4.0, 30.0
TIMES_S = (0.0, 0.4, 1.234, 2.5, 3.9)
BREEZE = PRESETS["breeze"]
GUSTS = PRESETS["autumn-gusts"]
STORM = PRESETS["storm-front"]

pytestmark = pytest.mark.skipif(
    not (REPOSITORY / "node_modules/playcanvas").exists() or not shutil.which("node"),
    reason="needs the package playcanvas: run make develop",
)


def played(file: Path, clip: str, times_s: tuple[float, ...]) -> list[Any]:
    """(v, 3) the places of all vertices in PlayCanvas, at each time."""
    asked = ["node", str(PLAYER), str(file), clip, *map(str, times_s)]
    done = subprocess.run(asked, capture_output=True, text=True, check=True, cwd=REPOSITORY)
    read = [json.loads(line) for line in done.stdout.splitlines()]
    assert all(clip in one["names"] for one in read)
    # in the order of the file, whatever that of PlayCanvas is
    order = ("wood", "twigs", "leaves")
    meshes = [sorted(one["meshes"], key=lambda mesh: order.index(mesh["name"].split("_")[1])) for one in read]
    return [np.concatenate([mesh["places"] for mesh in each]) for each in meshes]


@pytest.mark.parametrize(
    ("kind", "wind"), [("bones", GUSTS), ("bones", STORM), ("glb", BREEZE), ("live", BREEZE)]
)
def test_the_loop_is_that_of_the_table(tmp_path: Path, kind: str, wind: Wind) -> None:
    """Within what the file itself states, which for morph targets is the distance from straight lines.

    From these lines, which morph targets follow, PlayCanvas is less far.
    """
    table, glb = decode(SHIPPED.read_bytes()), SHIPPED.with_suffix(".glb").read_bytes()
    told = write_export(
        table, glb, kind, tmp_path, "tree", ExportOptions(wind=wind, seconds=SECONDS, fps=FPS)
    )
    rest_m, loop = GltfFile(glb, table).rest_m(), looped(table, wind, SECONDS, FPS)
    measured, height_m = told["measured"], float(table.metadata["height_m"])
    stated = measured["loop_error_percent_of_height" if kind == "live" else "error_percent_of_height"]
    modes = len(table.modal_step) if kind == "live" else table.modes
    rows = vertex_rows(table, rest_m)[:, :, :modes]
    for time_s, found in zip(TIMES_S, played(tmp_path / "tree.glb", "tree_sway", TIMES_S), strict=True):
        q = loop.q_at(time_s)
        exact = drawn_positions(table, rest_m, q)
        expected = exact if kind == "bones" else rest_m + rows @ q[:modes]
        off, format_off, sway = (
            100 / height_m * float(np.linalg.norm(one - other, axis=1).max())
            for one, other in ((found, exact), (found, expected), (exact, rest_m))
        )
        print(f"{kind}, {time_s} s: {off:.3f} %, from its format {format_off:.4f} %, sway {sway:.1f} %")
        assert off < 1.1 * stated + 0.01
        assert format_off < {"bones": 0.12 if wind is STORM else 0.1}.get(kind, 0.001)
        assert sway > 10 * off


def test_every_clip_of_several_winds_plays(tmp_path: Path) -> None:
    table, glb = decode(SHIPPED.read_bytes()), SHIPPED.with_suffix(".glb").read_bytes()
    winds = {"breeze": BREEZE, "autumn-gusts": GUSTS}
    write_export(table, glb, "bones", tmp_path, "oak", ExportOptions(winds=winds, seconds=2.0, fps=12.0))
    breeze, gusts = (played(tmp_path / "oak.glb", f"oak_{name}", (1.0,))[0] for name in winds)
    assert np.linalg.norm(gusts - breeze, axis=1).max() > 0.05
