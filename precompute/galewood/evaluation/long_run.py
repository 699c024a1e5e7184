"""Ten minutes of gusts beside the finite elements, window by window; and winds far beyond what was sampled.

The gusts of every window are the same and only their heading turns, once around over the whole run: an
error that grows from window to window is drift, and not a stronger wind.
"""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np

from galewood.evaluation.evaluate import METHODS, OnProgress
from galewood.evaluation.measures import ErrorByFrame, errors, joined, windows
from galewood.evaluation.reference_runs import ReferenceTask, read_reference_run, run_references
from galewood.evaluation.source import Source
from galewood.evaluation.winds import long_gusts
from galewood.fem import Simulator
from galewood.player import ModalForest
from galewood.sampling import content_hash
from galewood.table import Table
from galewood.util import Floats
from galewood.wind import dynamic_pressure

LONG_VERSION = 1
WINDOW = 1500
PIECE = 100
BEYOND = 2.0
"""Times the strongest sampled pressure."""
METHODS_SHOWN = ("modal", "paper")


def long_run(
    table: Table,
    source: Source,
    cache_dir: Path,
    on_progress: OnProgress,
    *,
    frames: int,
    sway: float,
    seed: int,
) -> dict[str, Any]:
    """Errors over windows of 1,500 frames of gusts that sway the tree by that share of its height.

    Kept in the cache by the content of the table, of the model and of the wind.
    """
    digest = hashlib.sha256(f"{LONG_VERSION} {content_hash(source.model)} {frames} {sway} {seed}".encode())
    for tensor in (*vars(table.modal).values(), table.node_basis, table.candidate):
        digest.update(np.ascontiguousarray(tensor).tobytes())
    kept = cache_dir / "evaluations" / f"{digest.hexdigest()}.json"
    if kept.exists():
        return json.loads(kept.read_text())
    found = _run(table, source, _wind(table, source, cache_dir, frames, sway, seed), on_progress)
    kept.parent.mkdir(parents=True, exist_ok=True)
    kept.write_text(json.dumps(found))
    return found


def _wind(table: Table, source: Source, cache_dir: Path, frames: int, sway: float, seed: int) -> Floats:
    """The gusts, scaled until their first window sways the tree as asked."""
    speed_m_s, dt_s = float(table.metadata["design_speed_m_s"]), float(table.metadata["dt_s"])
    wind = long_gusts(seed, frames, min(WINDOW, frames), dt_s, 0.8 * speed_m_s)
    first = wind[: min(WINDOW, frames)]
    task = ReferenceTask(
        source.model_path,
        first,
        sway * float(table.metadata["height_m"]),
        float(dynamic_pressure(speed_m_s)),
    )
    scaled = read_reference_run(run_references([task], cache_dir, lambda done: None)[0]).pressure_pa
    return wind * (np.linalg.norm(scaled, axis=1).max() / np.linalg.norm(first, axis=1).max())


def _run(table: Table, source: Source, wind: Floats, on_progress: OnProgress) -> dict[str, Any]:
    simulator = Simulator(source.model)
    forests = {name: METHODS[name](table) for name in METHODS_SHOWN}
    dt_s, height_m = float(table.metadata["dt_s"]), float(table.metadata["height_m"])
    parts: dict[str, list[ErrorByFrame]] = {name: [] for name in forests}
    late: dict[str, Floats] = {}  # what is shown right after a step is the pose before it
    for start in range(0, len(wind), PIECE):
        on_progress(start / len(wind), f"Frame {start:,} of {len(wind):,}")
        piece = wind[start : start + PIECE]
        reference = np.empty((len(piece), source.model.vertex_count, 3), np.float32)
        tracks = {name: np.empty((len(piece), source.subspace.modes)) for name in forests}
        for k, pressure in enumerate(piece):
            simulator.step(pressure)
            reference[k] = simulator.u
            for name, forest in forests.items():
                forest.advance(dt_s, [pressure[0]], [pressure[1]])
                tracks[name][k] = forest.q[0]
        for name, track in tracks.items():
            # a pose behind: compared with the truth a frame earlier
            shifted = np.concatenate(
                [late.get(f"reference-{name}", np.zeros((1, *reference.shape[1:]))), reference[:-1]]
            )
            parts[name].append(errors(source.subspace.expand(track), shifted))
            late[f"reference-{name}"] = reference[-1:].astype(np.float64)
    on_progress(1.0, "Done")
    return {
        "frames": len(wind),
        "window": WINDOW,
        "methods": {name: windows(joined(part), WINDOW, height_m) for name, part in parts.items()},
    }


def beyond(table: Table, source: Source, *, times: float = BEYOND, frames: int = 1800) -> dict[str, float]:
    """The drift-free method under so many times the strongest sampled pressure, back and forth, then still
    air.

    The largest displacement of any of the wood's vertices over the height, the largest coverage, and what
    is left after 4 minutes of still air.
    """
    forest = METHODS["modal"](table)
    assert isinstance(forest, ModalForest)
    dt_s, height_m = float(table.metadata["dt_s"]), float(table.metadata["height_m"])
    peak = times * float(dynamic_pressure(float(table.metadata["design_speed_m_s"])))
    poses, extrapolation_ratio = [], 0.0
    for frame in range(frames):
        sign = 1.0 if (frame // 45) % 2 == 0 else -1.0
        forest.advance(dt_s, [sign * peak], [0.4 * sign * peak])
        poses.append(forest.q[0].astype(np.float64))
        extrapolation_ratio = max(extrapolation_ratio, float(forest.extrapolation_ratio[0]))
    moved = [source.subspace.expand(np.array(poses[a : a + 64])) for a in range(0, frames, 64)]
    for _ in range(round(240 / dt_s)):
        forest.advance(dt_s, [0.0], [0.0])
    return {
        "times": times,
        "largest": float(max(np.linalg.norm(part, axis=2).max() for part in moved) / height_m),
        "extrapolation_ratio": extrapolation_ratio,
        "left_at_rest_m": float(np.abs(forest.q).max()),
    }
