"""A build of a very small tree, which compiles all numeric kernels and leaves them in numba's cache.

Without it the first build on a machine compiles them on the way, which takes longer than the build itself.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from galewood.constants import WIND_MODELS
from galewood.motion.wind import Wind, WindField
from galewood.options import METHOD_NAMES
from galewood.pipeline.sampling import SampleTask, run_task
from galewood.pipeline.stages.build import build_table
from galewood.pipeline.tables import BuildOptions
from galewood.player import WindDrivenForest, WindDrivenTrees
from galewood.table import Table, decode
from galewood.util import Floats, compile_once

TUBE_SIDES, TUBE_RINGS = 10, 6
RUN_FRAMES = 24
LIMBS = (
    # start, end (m), radius at both (m): overlapping, as in most tree meshes
    ((0.0, 0.0, 0.0), (0.0, 2.6, 0.0), 0.15, 0.12),
    ((0.0, 2.5, 0.0), (1.6, 4.6, 0.0), 0.09, 0.04),
    ((0.0, 2.5, 0.0), (-1.5, 4.9, 0.4), 0.09, 0.04),
)
OPTIONS = BuildOptions(
    species="maple",
    height_m=5.0,
    up_axis="y",
    stiffness="as drawn",
    target_tets=600,
    sampled_elements=4,
    frames=4,
    reference_frames=2,
)


def compile_kernels(on_progress: Callable[[float], None] = lambda fraction: None) -> None:
    """Compile the kernels of a build and of both methods in every wind, unless they are in numba's cache.

    ``on_progress`` gets the fraction done. Waits while another process compiles them.
    """
    compile_once(lambda: _compile(on_progress))


def _compile(on_progress: Callable[[float], None]) -> None:
    with tempfile.TemporaryDirectory() as folder:
        result = build_table(
            small_tree_obj(),
            "small-tree.obj",
            OPTIONS,
            runner=_first_runs,
            progress=lambda progress: on_progress(0.8 * progress.fraction),
            cache_dir=Path(folder),
        )
    _play(decode(result.whole_table()))
    on_progress(1.0)


def small_tree_obj() -> bytes:
    """A trunk with two branches and two leaves, as an OBJ file."""
    lines, count = ["o wood"], 0
    for start, end, *radii in LIMBS:
        vertices = _tube(np.array(start), np.array(end), *radii)
        lines += [f"v {x:.5f} {y:.5f} {z:.5f}" for x, y, z in vertices]
        lines += [f"f {' '.join(str(count + 1 + k) for k in face)}" for face in _tube_faces()]
        count += len(vertices)
    lines.append("o leaves")
    for _, (x, y, z), *_ in LIMBS[1:]:
        corners = ((x - 0.2, y), (x + 0.2, y), (x + 0.2, y + 0.4), (x - 0.2, y + 0.4))
        lines += [f"v {a:.5f} {b:.5f} {z:.5f}" for a, b in corners]
        lines.append(f"f {count + 1} {count + 2} {count + 3} {count + 4}")
        count += 4
    return "\n".join(lines).encode()


def _tube(start: Floats, end: Floats, radius_start_m: float, radius_end_m: float) -> Floats:
    axis = (end - start) / np.linalg.norm(end - start)
    side = np.cross(axis, (0.0, 0.0, 1.0))
    side /= np.linalg.norm(side)
    angle = np.arange(TUBE_SIDES) * 2 * np.pi / TUBE_SIDES
    circle = np.cos(angle)[:, None] * side + np.sin(angle)[:, None] * np.cross(axis, side)
    share = np.linspace(0, 1, TUBE_RINGS)[:, None, None]
    radius = radius_start_m + (radius_end_m - radius_start_m) * share
    return (start + share * (end - start) + radius * circle).reshape(-1, 3)


def _tube_faces() -> list[tuple[int, ...]]:
    faces: list[tuple[int, ...]] = []
    for ring in range(TUBE_RINGS - 1):
        for k in range(TUBE_SIDES):
            a, b = ring * TUBE_SIDES + k, ring * TUBE_SIDES + (k + 1) % TUBE_SIDES
            faces.append((a, b, b + TUBE_SIDES, a + TUBE_SIDES))
    last = (TUBE_RINGS - 1) * TUBE_SIDES
    return [*faces, tuple(reversed(range(TUBE_SIDES))), tuple(range(last, last + TUBE_SIDES))]


def _first_runs(tasks: Sequence[SampleTask], done: Callable[[int], None]) -> list[Path]:
    """Simulate the first frames of the runs in this process, one after the other."""
    paths: list[Path] = []
    for task in tasks:
        first = replace(task.wind, pressure_pa=task.wind.pressure_pa[:RUN_FRAMES])
        paths.append(run_task(replace(task, wind=first)))
        done(len(paths))
    return paths


def _play(table: Table) -> None:
    trees = [[0.0, 0.0, 0.0, 1.0], [10.0, 5.0, 1.0, 0.8]]
    for method in METHOD_NAMES:
        forest = WindDrivenTrees(table, trees, method)
        for model in WIND_MODELS:
            forest.step(WindField(Wind(model=model)), 1.0, 1 / 30)
        WindDrivenForest([forest]).step(WindField(Wind()), 2.0, 1 / 30)


if __name__ == "__main__":
    compile_kernels()
