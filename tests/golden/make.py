"""Write the golden files for the Python and TypeScript tests: ``python -m tests.golden.make``."""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace
from typing import Any

import numpy as np
import scipy.sparse
from galewood.motion.wind.evaluation import Wind, wind_pressure
from galewood.pipeline.reduction.training import ModalTraining, Size
from galewood.pipeline.sampling import gust_shapes, training_shapes
from galewood.pipeline.sampling.recording import SampleWind, Trajectory, sample_trajectory, sample_winds
from galewood.pipeline.tables.assemble import TableContext, assemble_table
from galewood.pipeline.tables.options import TableSettings
from galewood.pipeline.tables.surface import RenderMesh
from galewood.player.modal_forest import ModalForest
from galewood.player.paper_search import PaperForest
from galewood.solid.fem.model import FemSettings
from galewood.solid.skinning import Axis, Bindings
from galewood.table.format import Table, encode
from galewood.table.records import encode_records
from scipy.sparse import csr_matrix

from tests.golden import GOLDEN_FOLDER
from tests.golden.beam import Beam

WINDS = (
    Wind(),
    Wind(mean_speed_m_s=0.0),
    Wind(
        mean_speed_m_s=17.5, direction_deg=-140.0, gustiness=1.0, convection_speed_m_s=12.0, seed=4294967295
    ),
    Wind(mean_speed_m_s=3.0, direction_deg=200.0, gustiness=0.0, seed=77),
)
FRAMES = 600
WALK_WINDS = {
    0: Wind(9.0, 30.0, 0.8, 6.0, 3),
    150: Wind(6.0, 250.0, 0.8, 6.0, 4),
    280: Wind(mean_speed_m_s=0.0),
}
"""Winds of ``paper_steps`` by the first frame of each."""
SWAY_SAID = {
    "frame_s": 1 / 30,
    "pressure_pa": "frame k, tree at x, z: a (1 + cos(0.05 k + x)) (1 + cos(0.013 k) / 2) along world x, "
    "a cos(0.031 k + z) along world z, a = 12 up to frame 8999, then 0; poses of frames every - 1, …",
}
"""What ``sway_steps`` does, for readers of its file."""
KINDS = tuple(f"{kind}-{d:03d}" for kind in ("cosine-1", "cosine-5", "gust") for d in (0, 120, 240))
SMALL = TableSettings(sigma_share=0.3, weight_initial=0.3, weight_maximum=0.5, weight_growth=0.01)
GUST_RUNS = 6
"""Training runs of the small system with gusts that differ from mass to mass."""
FIT_ITERATIONS = 0
"""Only the linear fit, which every processor repeats to nine digits.

The minimiser after it is stopped before its end and enlarges differences of rounding, which are those of the
processor, until they are seen: 0.1 % of the sway after its 100 iterations.
"""
SAVED_EVERY = 10


def beam_runs(beam: Beam, frames: int = 60, design_speed_m_s: float = 12.0) -> list[Trajectory]:
    """All recorded runs that a table of the small system needs."""
    points = np.arange(beam.n)
    winds = beam_winds(beam, frames, design_speed_m_s)
    return [sample_trajectory(beam, wind, points, beam.dt_s) for wind in winds]


def beam_winds(beam: Beam, frames: int = 60, design_speed_m_s: float = 12.0) -> list[SampleWind]:
    """The winds of the recorded runs."""
    winds = sample_winds(design_speed_m_s, beam.dt_s, beam.streamlined_exponent, frames)
    return [wind for wind in winds if wind.name.startswith((*KINDS, "still"))]


def beam_mesh(beam: Beam) -> RenderMesh:
    """Two render vertices beside each mass, and a leaf at the top one."""
    sides = np.array([[0.1, 0.0, 0.0], [-0.1, 0.0, 0.0]])
    wood = (beam.rest_m[:, None, :] + sides).reshape(-1, 3)
    leaf = beam.rest_m[-1] + np.array([[0.0, 0.1, 0.0], [0.2, 0.1, 0.0], [0.0, 0.3, 0.1]])
    owner = np.concatenate([np.repeat(np.arange(beam.n), 2), np.full(3, beam.n - 1)])
    embedding = scipy.sparse.csr_matrix(
        (np.ones(len(owner)), (np.arange(len(owner)), owner)), shape=(len(owner), beam.n)
    )
    primitives = [
        {"name": "wood_0", "kind": "wood", "vertices": len(wood)},
        {"name": "leaves_0", "kind": "leaves", "vertices": 3},
    ]
    child = np.maximum(owner, 1)
    place = beam.rest_m[owner]
    bindings = Bindings(child, (owner > 0).astype(np.float64), place, np.zeros(len(owner)))
    return RenderMesh(np.concatenate([wood, leaf]), embedding, primitives, beam_axis(beam), bindings)


def beam_axis(beam: Beam) -> Axis:
    """The masses as points of an axis, which turn as their neighbours move."""
    n = beam.n
    turned = scipy.sparse.lil_matrix((3 * n, 3 * n))
    for point in range(n):
        low, high = max(point - 1, 0), min(point + 1, n - 1)
        rise_m = beam.rest_m[high, 1] - beam.rest_m[low, 1]
        for end, share in ((low, -1 / rise_m), (high, 1 / rise_m)):
            turned[3 * point, 3 * end + 2] += share
            turned[3 * point + 2, 3 * end] -= share
    moved = scipy.sparse.identity(n, format="csr")
    parent = np.arange(-1, n - 1)
    return Axis(beam.rest_m, parent, np.full(n, 0.05), csr_matrix(moved), csr_matrix(turned))


def beam_table(settings: TableSettings = SMALL, frames: int = 40) -> Table:
    """A small but valid table."""
    beam = Beam()
    description = {
        "species": "pole",
        "height_m": beam.height_m,
        "dt_s": beam.dt_s,
        "design_speed_m_s": 12.0,
        "streamlined_exponent": beam.streamlined_exponent,
        "mesh_sha256": "0" * 64,
        "frequencies_hz": [],
        "provenance": {"made_by": "tests/golden/make.py"},
    }
    runs = beam_runs(beam, frames)
    shapes = training_shapes(beam.first_hz, beam.dt_s, beam.streamlined_exponent)
    shapes += gust_shapes(beam.dt_s, beam.streamlined_exponent, count=GUST_RUNS)
    winds = [shape.at(12.0) for shape in shapes]
    training = [sample_trajectory(beam, wind, np.arange(beam.n), beam.dt_s) for wind in winds]
    training = ModalTraining(
        beam.oscillators(), scheme(beam), training, size=Size(5, 3, 5), fit_iterations=FIT_ITERATIONS
    )
    of = TableContext(beam.mass_kg, beam_mesh(beam), description, settings)
    return assemble_table(runs, beam_winds(beam, frames), training, of)


def scheme(beam: Beam) -> FemSettings:
    """FEM settings with the time scheme of the small system."""
    return FemSettings(dt_s=beam.dt_s, scheme="backward-euler")


def wind_vectors() -> list[dict[str, object]]:
    """Pressures at a few places and times in every wind."""
    rng = np.random.default_rng(20)
    x, z = rng.uniform(-300, 300, (2, 5)).astype(np.float32)
    out_x, out_z = np.zeros(5, np.float32), np.zeros(5, np.float32)
    rows: list[dict[str, object]] = []
    for wind in WINDS:
        for time_s, exponent in ((0.0, 1.3), (1.25, 1.64), (3601.5, 2.0)):
            wind_pressure(wind, x, z, time_s, out_x, out_z, exponent)
            rows.append(
                {"wind": wind.document(), "time_s": time_s, "exponent": exponent,
                 "x_m": x.tolist(), "z_m": z.tolist(),
                 "pressure_x_pa": out_x.tolist(), "pressure_z_pa": out_z.tolist()}
            )  # fmt: skip
    return rows


def paper_steps(table: Table, easing: float) -> dict[str, Any]:
    """Records and poses of trees with different yaw and size in a wind that changes and then stops."""
    rng = np.random.default_rng(7)
    count = 6
    x, z = rng.uniform(-20, 20, (2, count)).astype(np.float32)
    yaw, scale = rng.uniform(-3, 3, count).astype(np.float32), rng.uniform(0.6, 1.6, count).astype(np.float32)
    forest = PaperForest(table, count, pose_easing=easing)
    forest.set_trees(x, z, yaw, scale)
    out_x, out_z = np.zeros(count, np.float32), np.zeros(count, np.float32)
    records: list[list[int]] = []
    poses: list[list[float]] = []
    for frame in range(FRAMES):
        wind = WALK_WINDS[max(first for first in WALK_WINDS if first <= frame)]
        wind_pressure(wind, x, z, frame / 30, out_x, out_z, table.streamlined_exponent)
        forest.advance(1 / 30, out_x, out_z)
        records.append(forest.record.tolist())
        if frame % SAVED_EVERY == 0:
            poses.append([float(f"{value:.9g}") for value in forest.q.ravel()])
    trees = {"x_m": x.tolist(), "z_m": z.tolist(), "yaw_rad": yaw.tolist(), "scale": scale.tolist()}
    said = {
        "table": "pole.safetensors",
        "frame_s": 1 / 30,
        "every": SAVED_EVERY,
        "time": "frame k has the pressure at k * frame_s, rounded to float32; poses of frames 0, every, …",
        "wind_from_frame": {str(frame): wind.document() for frame, wind in WALK_WINDS.items()},
    }
    return {**said, "pose_easing": easing, "trees": trees, "records": records, "poses": poses}


def sway_steps(table: Table) -> dict[str, Any]:
    """Poses of the modal model over 10,000 frames: 9,000 in a varying wind, then still air."""
    rng = np.random.default_rng(8)
    count, frames = 4, 10_000
    x, z = rng.uniform(-20, 20, (2, count)).astype(np.float32)
    yaw, scale = rng.uniform(-3, 3, count).astype(np.float32), rng.uniform(0.6, 1.6, count).astype(np.float32)
    forest = ModalForest(table.modal, table.metadata["dt_s"], table.mode_scale, count)
    forest.set_trees(x, z, yaw, scale)
    out_x, out_z = np.zeros(count, np.float32), np.zeros(count, np.float32)
    poses: list[list[float]] = []
    for frame in range(frames):
        strength = 12.0 if frame < 9000 else 0.0
        # Plain cosines, which both languages compute equally; the winds have their own golden files.
        out_x[:] = strength * (1 + np.cos(0.05 * frame + x)) * (1 + 0.5 * np.cos(0.013 * frame))
        out_z[:] = strength * np.cos(0.031 * frame + z)
        forest.advance(1 / 30, out_x, out_z)
        if frame % 100 == 99:
            poses.append([float(f"{value:.9g}") for value in forest.q.ravel()])
    trees = {"x_m": x.tolist(), "z_m": z.tolist(), "yaw_rad": yaw.tolist(), "scale": scale.tolist()}
    return {**SWAY_SAID, "frames": frames, "every": 100, "trees": trees, "poses": poses}


def main() -> None:
    table = beam_table()
    (GOLDEN_FOLDER / "pole.safetensors").write_bytes(encode(table))
    alone = encode(replace(table, paper=None))
    (GOLDEN_FOLDER / "pole-table.safetensors").write_bytes(alone)
    records = encode_records(table.records, hashlib.sha256(alone).hexdigest())
    (GOLDEN_FOLDER / "pole-records.safetensors").write_bytes(records)
    steps = [paper_steps(table, easing) for easing in (0.0, 0.1)]
    for name, content in (
        ("wind.json", wind_vectors()),
        ("walk.json", steps),
        ("sway.json", sway_steps(table)),
    ):
        (GOLDEN_FOLDER / name).write_text(json.dumps(content, separators=(",", ":")) + "\n")


if __name__ == "__main__":
    main()
