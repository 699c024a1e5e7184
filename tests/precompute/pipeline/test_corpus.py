"""Builds of real trees in the folder CORPUS: every tree with wood must give a valid table.

CORPUS_REPORT=FILE receives one line of results per tree; CORPUS_CACHE=FOLDER caches the tetrahedra.
"""

import os
from pathlib import Path
from time import perf_counter

import numpy as np
import pytest
from galewood.pipeline.reduction import wind_scale
from galewood.pipeline.stages.build import build_table
from galewood.pipeline.tables.options import BuildOptions
from galewood.table.format import decode
from galewood.util import MeshError

FOLDER = Path(os.environ.get("CORPUS", ""))
REPORT = os.environ.get("CORPUS_REPORT")
CACHE = Path(os.environ["CORPUS_CACHE"]) if os.environ.get("CORPUS_CACHE") else None
TYPES = (".glb", ".gltf", ".obj", ".ply", ".stl", ".fbx", ".zip")
FILES = sorted(p for p in FOLDER.rglob("*") if p.suffix in TYPES) if os.environ.get("CORPUS") else []
UNSUPPORTED = ("external-buffers",)
QUICK = BuildOptions(frames=24, reference_frames=0)
"""All stages of a build, with short winds."""
TRAINING_WINDS = 5
"""Only the first of the training winds of the modal model, of each kind."""


@pytest.mark.skipif(not FILES, reason="CORPUS is not set to a folder with trees")
@pytest.mark.parametrize("path", FILES, ids=lambda p: p.name)
def test_real_tree(path, tmp_path, monkeypatch):
    monkeypatch.setattr(wind_scale, "WIND_COUNT", TRAINING_WINDS)
    monkeypatch.setattr(wind_scale, "GUST_WIND_COUNT", TRAINING_WINDS)
    begin = perf_counter()
    try:
        built = build_table(path.read_bytes(), path.name, QUICK, cache_dir=CACHE or tmp_path)
    except MeshError as error:
        assert error.code in UNSUPPORTED  # rejected with a specific error rather than misread
        report_row(path.name, error.code)
        return
    report, table = built.report, decode(built.whole_table())
    meshing, model = report["meshing"], report["model"]
    first_hz = model["frequencies_hz"][0]
    wood_faces = sum(part["faces"] for part in report["import"]["parts"] if part["kind"] == "wood")
    warnings = [*report["import"]["warnings"], *meshing["warnings"]]
    warnings += [model["rest_pose"]["warning"]] if "warning" in model["rest_pose"] else []
    report_row(path.name, wood_faces, meshing["tets"], meshing["components"], f"{meshing['lost_extent']:.1%}",
         f"{first_hz:.2f} Hz", f"{model['wood_mass_kg']:.0f} kg", f"{perf_counter() - begin:.0f} s",
         "; ".join(warnings))  # fmt: skip
    assert 1.0 < report["import"]["height_m"] < 60.0
    assert 3000 <= meshing["tets"] <= 8000
    assert meshing["components"] == 1
    assert meshing["lost_extent"] <= 0.03
    assert 0.05 < first_hz < 20.0
    assert np.isfinite(table.node_basis.astype(np.float64)).all()
    assert len(table.records.dq) == table.records.metadata["records"] > 500


def report_row(*cells):
    """Report one row of a Markdown table."""
    line = "| " + " | ".join(str(cell) for cell in cells) + " |"
    print(line)
    if REPORT:
        with Path(REPORT).open("a") as file:
            file.write(line + "\n")
