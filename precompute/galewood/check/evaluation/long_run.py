"""Errors over ten minutes of gusts, window by window, and behaviour far beyond the sampled winds.

The gusts of all windows are the same; only their heading turns, once around over the whole run. An error that
grows from window to window is therefore drift and not an effect of a stronger wind.
"""

from __future__ import annotations

import hashlib
import importlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from galewood.check.evaluation.evaluate import METHODS, OnProgress, methods_of
from galewood.check.evaluation.measures import ErrorByFrame, errors, joined, windows
from galewood.check.evaluation.reference_runs import ReferenceTask, read_reference_run, run_references
from galewood.check.evaluation.source import Source
from galewood.check.evaluation.winds import long_gusts
from galewood.motion.wind import dynamic_pressure
from galewood.options import METHOD_NAMES
from galewood.pipeline.sampling import content_hash
from galewood.player import ModalForest
from galewood.solid.fem import Simulator
from galewood.table import Table, encode
from galewood.util import Floats

METHOD_PACKAGES = ("galewood.motion", "galewood.player", "galewood.solid.fem", "galewood.check.evaluation")
"""Packages whose code decides the result of a long run: both methods, the reference solution, the errors."""
WINDOW_FRAMES = 1500
PIECE_FRAMES = 100
"""Frames of a window, and of the pieces that are held in memory."""
BEYOND_PRESSURE_RATIO = 2.0
"""Pressure of `play_beyond_range` over the pressure of the design speed."""


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
    """Errors in windows of 1,500 frames under gusts that sway the tree by ``sway`` times its height.

    The result is cached under ``cache_dir``/evaluations by ``long_run_key``.
    """
    key = long_run_key(table, source, frames=frames, sway=sway, seed=seed)
    kept = cache_dir / "evaluations" / f"{key}.json"
    if kept.exists():
        return json.loads(kept.read_text())
    found = _run(table, source, _wind(table, source, cache_dir, frames, sway, seed), on_progress)
    kept.parent.mkdir(parents=True, exist_ok=True)
    kept.write_text(json.dumps(found))
    return found


def long_run_key(table: Table, source: Source, *, frames: int, sway: float, seed: int) -> str:
    """SHA-256 of everything that decides a long run: its settings, the model, table, modes and code."""
    digest = hashlib.sha256(f"{content_hash(source.model)} {frames} {sway} {seed}".encode())
    digest.update(encode(table))
    digest.update(np.ascontiguousarray(source.subspace.basis).tobytes())
    digest.update(source_hash(METHOD_PACKAGES).encode())
    return digest.hexdigest()


def source_hash(packages: Sequence[str]) -> str:
    """SHA-256 of the Python sources of the named packages. Raises ImportError for an unknown package."""
    digest = hashlib.sha256()
    for name in packages:
        for folder in map(Path, importlib.import_module(name).__path__):
            for path in sorted(folder.rglob("*.py")):
                content = path.read_bytes()
                digest.update(f"{name} {path.relative_to(folder).as_posix()} {len(content)}\n".encode())
                digest.update(content)
    return digest.hexdigest()


def _wind(table: Table, source: Source, cache_dir: Path, frames: int, sway: float, seed: int) -> Floats:
    """(frames, 2) Pa: the gusts, scaled so that their first window sways the tree as requested."""
    speed_m_s, dt_s = float(table.metadata["design_speed_m_s"]), float(table.metadata["dt_s"])
    exponent, window = table.streamlined_exponent, min(WINDOW_FRAMES, frames)
    wind = long_gusts(seed, frames, window, dt_s, 0.8 * speed_m_s, exponent)
    first = wind[:window]
    task = ReferenceTask(
        source.model_path,
        first,
        sway * float(table.metadata["height_m"]),
        float(dynamic_pressure(speed_m_s, exponent)),
    )
    scaled = read_reference_run(run_references([task], cache_dir, lambda done: None)[0]).pressure_pa
    return wind * (np.linalg.norm(scaled, axis=1).max() / np.linalg.norm(first, axis=1).max())


def _run(table: Table, source: Source, wind: Floats, on_progress: OnProgress) -> dict[str, Any]:
    simulator = Simulator(source.model)
    forests = {name: make(table) for name, make in methods_of(table).items() if name in METHOD_NAMES}
    dt_s, height_m = float(table.metadata["dt_s"]), float(table.metadata["height_m"])
    parts: dict[str, list[ErrorByFrame]] = {name: [] for name in forests}
    late: dict[str, Floats] = {}  # right after a step, q is the pose before that step
    for start in range(0, len(wind), PIECE_FRAMES):
        on_progress(start / len(wind), f"Frame {start:,} of {len(wind):,}")
        piece = wind[start : start + PIECE_FRAMES]
        reference = np.empty((len(piece), source.model.vertex_count, 3), np.float32)
        tracks = {name: np.empty((len(piece), source.subspace.modes)) for name in forests}
        for k, pressure in enumerate(piece):
            simulator.step(pressure)
            reference[k] = simulator.u
            for name, forest in forests.items():
                forest.advance(dt_s, [pressure[0]], [pressure[1]])
                tracks[name][k] = forest.q[0]
        for name, track in tracks.items():
            # The poses lag by one frame: compare them with the reference solution one frame earlier.
            shifted = np.concatenate(
                [late.get(f"reference-{name}", np.zeros((1, *reference.shape[1:]))), reference[:-1]]
            )
            parts[name].append(errors(source.subspace.expand(track), shifted))
            late[f"reference-{name}"] = reference[-1:].astype(np.float64)
    on_progress(1.0, "Done")
    return {
        "frames": len(wind),
        "window": WINDOW_FRAMES,
        "methods": {name: windows(joined(part), WINDOW_FRAMES, height_m) for name, part in parts.items()},
    }


def play_beyond_range(
    table: Table, source: Source, *, times: float = BEYOND_PRESSURE_RATIO, frames: int = 1800
) -> dict[str, float]:
    """Play the modal model far beyond the sampled winds, then in still air.

    The pressure is ``times`` the strongest one of the table's winds and changes sign every 45 frames. Returns
    the largest displacement of a vertex of the wood over the height, the largest extrapolation ratio,
    and the largest coordinate q left after 4 minutes of still air, m.
    """
    forest = METHODS["modal"](table)
    assert isinstance(forest, ModalForest)
    dt_s, height_m = float(table.metadata["dt_s"]), float(table.metadata["height_m"])
    peak = times * table.peak_pressure_pa
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
