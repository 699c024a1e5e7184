"""Write the golden steps of both methods: ``python -m tests.golden.make_walks``.

They cover 10,000 frames under every wind model. Every hundred frames hold a digest of all records that the
paper's state search has found so far, and the poses of the modal model.
"""

from __future__ import annotations

import hashlib
import json
from typing import Any

import numpy as np
from galewood.motion.wind.evaluation import Wind, WindField
from galewood.player.modal_forest import ModalForest
from galewood.player.paper_search import PaperForest
from galewood.table.format import Table, decode

from tests.golden import GOLDEN_FOLDER

FRAMES, EVERY, FRAME_S = 10_000, 100, 1.0 / 30.0
STEPS_PER_PA = 4
"""Pressures are rounded, so that the last bit of a velocity cannot change a record."""
GUSTY: dict[str, Any] = {"mean_speed_m_s": 9.0, "direction_deg": 40.0, "gustiness": 0.8, "seed": 12}
WINDS = (
    Wind(**GUSTY, model="cosine"),
    Wind(**GUSTY, model="perlin", length_scale_m=30.0),
    Wind(**GUSTY, model="spectral", length_scale_m=30.0),
    Wind(**GUSTY, model="navier-stokes", length_scale_m=20.0),
)
SAID = {
    "table": "pole.safetensors",
    "frame_s": FRAME_S,
    "pressure_pa": "frame k: that at k * frame_s at the tree, without profile or compression, rounded to "
    "1 / steps_per_pa; records: SHA-256 (16 digits) of all records so far as int32; poses: the modal model",
}
TREES: dict[str, list[float]] = {
    "x_m": [-11.5, 3.25, 18.0],
    "z_m": [4.0, -9.75, 12.5],
    "yaw_rad": [0.5, -2.25, 3.0],
    "scale": [0.75, 1.0, 1.5],
}


def rounded(pressure_pa: np.ndarray) -> np.ndarray:
    return np.floor(pressure_pa * STEPS_PER_PA + 0.5) / STEPS_PER_PA


def step_digests(table: Table, wind: Wind) -> dict[str, Any]:
    """Digests of the records of the paper's search, and poses of the modal model, under a wind."""
    count = len(TREES["x_m"])
    field, x, z = WindField(wind), np.array(TREES["x_m"]), np.array(TREES["z_m"])
    paper = PaperForest(table, count)
    modal = ModalForest(table.modal, float(table.metadata["dt_s"]), table.mode_scale, count)
    for forest in (paper, modal):
        forest.set_trees(TREES["x_m"], TREES["z_m"], TREES["yaw_rad"], TREES["scale"])
    px, pz = np.zeros(count), np.zeros(count)
    digests: list[str] = []
    poses: list[list[float]] = []
    records = hashlib.sha256()
    for frame in range(FRAMES):
        field.pressure(x, z, frame * FRAME_S, px, pz, table.streamlined_exponent)
        acting = rounded(px), rounded(pz)
        paper.advance(FRAME_S, *acting)
        modal.advance(FRAME_S, *acting)
        records.update(paper.record.astype("<i4").tobytes())
        if frame % EVERY == EVERY - 1:
            digests.append(records.hexdigest()[:16])
            poses.append([float(f"{value:.9g}") for value in modal.q.ravel()])
    return {"wind": wind.document(), "records": digests, "poses": poses}


def main() -> None:
    table = decode((GOLDEN_FOLDER / "pole.safetensors").read_bytes())
    content = {
        **SAID, "frames": FRAMES, "every": EVERY, "steps_per_pa": STEPS_PER_PA, "trees": TREES,
        "walks": [step_digests(table, wind) for wind in WINDS],
    }  # fmt: skip
    (GOLDEN_FOLDER / "walks.json").write_text(json.dumps(content, separators=(",", ":")) + "\n")


if __name__ == "__main__":
    main()
