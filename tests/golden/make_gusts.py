"""Write the golden motion of trees in a wind field: ``python -m tests.golden.make_gusts``.

It covers what lies between a wind document and the poses: the pressure at every tree and its compression
beyond the sampled range, the gusts within the crowns, and the modal model.
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from galewood.motion.wind import Wind, WindField, crown_carried, crown_field, write_gusts
from galewood.player import WindDrivenTrees
from galewood.table import Table, decode

from tests.golden import GOLDEN_FOLDER
from tests.golden.make_walks import TREES

FRAMES, EVERY, FRAME_S = 1500, 50, 1.0 / 30.0
GUSTY: dict[str, Any] = {"direction_deg": 40.0, "gustiness": 0.8, "seed": 12}
WINDS = (
    Wind(mean_speed_m_s=6.0, **GUSTY, model="spectral", length_scale_m=30.0),
    Wind(mean_speed_m_s=60.0, **GUSTY, model="spectral", length_scale_m=30.0),
    Wind(mean_speed_m_s=9.0, **GUSTY, model="cosine"),
    Wind(mean_speed_m_s=0.0, **GUSTY, model="perlin", length_scale_m=18.0),
)
SAID = {
    "table": "pole.safetensors",
    "frame_s": FRAME_S,
    "about": "the winds follow one another at equal intervals; frame k ends at (k + 1) * frame_s; gusts: at "
    "7.25 s in the first wind, under pressures (0, 0), (9, 4.5), (40, 20) Pa at the trees",
}


def rows() -> np.ndarray:
    return np.column_stack([TREES[name] for name in ("x_m", "z_m", "yaw_rad", "scale")])


def motion(table: Table) -> list[list[float]]:
    """Poses every EVERY frames while the wind changes from each of WINDS to the next."""
    trees, field = WindDrivenTrees(table, rows()), WindField(WINDS[0])
    poses: list[list[float]] = []
    for frame in range(FRAMES):
        turn, rest = divmod(frame, FRAMES // len(WINDS))
        if frame and not rest:
            field.change(WINDS[turn], frame * FRAME_S)
        trees.step(field, (frame + 1) * FRAME_S, FRAME_S)
        if frame % EVERY == EVERY - 1:
            poses.append([float(f"{value:.9g}") for value in trees.q.ravel()])
    return poses


def gusts(table: Table) -> list[float]:
    """Relative gusts at the places of every tree at one moment."""
    place = np.ascontiguousarray(table.modal_place, np.float64)
    x, z, yaw, size = rows().astype(np.float32).astype(np.float64).T.copy()
    turn = np.column_stack([np.cos(yaw), np.sin(yaw)])
    out = np.zeros((len(x), 2 * len(place)))
    moment = WindField(WINDS[0]).at(7.25)
    strength = np.array([0.0, 9.0, 40.0])
    pressure, exponent = (strength, 0.5 * strength), table.streamlined_exponent
    carried = crown_carried(moment)
    write_gusts(crown_field(12), carried, place, (x, z), turn, size, pressure, exponent, out)
    return out.ravel().tolist()


def main() -> None:
    table = decode((GOLDEN_FOLDER / "pole.safetensors").read_bytes())
    content = {
        **SAID, "frames": FRAMES, "every": EVERY, "trees": TREES,
        "winds": [wind.document() for wind in WINDS],
        "gusts": gusts(table), "poses": motion(table),
    }  # fmt: skip
    (GOLDEN_FOLDER / "gusts.json").write_text(json.dumps(content, separators=(",", ":")) + "\n")


if __name__ == "__main__":
    main()
