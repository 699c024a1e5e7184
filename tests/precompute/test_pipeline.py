"""The whole way on a small tree: from bytes of a mesh to a table that moves, and how it is stopped."""

from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from precompute.intake_types import IntakeError, IntakeOptions
from precompute.lookup import ForestLookup
from precompute.pipeline import BuildOptions, Cancelled, Progress, build_table
from precompute.runner import SampleTask, run_task
from precompute.table import decode
from tests.precompute.tree_meshes import BRANCHES, cards, glb_bytes, y_tree

OPTIONS = BuildOptions(
    intake=IntakeOptions(species="maple"),
    target_tets=800,
    sampled_elements=8,
    design_speed_m_s=20.0,
    frames=12,
)


def in_this_process(tasks: Sequence[SampleTask], done: Callable[[int], None]) -> list[Path]:
    paths = [run_task(task) for task in tasks]
    done(len(tasks))
    return paths


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("cache")


@pytest.fixture(scope="module")
def mesh() -> bytes:
    return glb_bytes(y_tree(), cards([end for _, end in BRANCHES]))


def test_a_mesh_becomes_a_table_that_moves(mesh: bytes, cache: Path) -> None:
    told: list[Progress] = []
    result = build_table(mesh, "tree.glb", OPTIONS, in_this_process, told.append, cache)
    table = decode(result.table)
    assert told[0].stage == "intake"
    assert told[-1].stage == "done"
    assert told[-1].fraction == 1.0
    assert all(a.fraction <= b.fraction + 1e-9 for a, b in pairwise(told))
    assert table.metadata["species"] == "maple"
    assert sum(p["vertices"] for p in table.metadata["primitives"]) == len(table.vertex_node)
    forest = ForestLookup(table, 1)
    for _ in range(40):
        forest.advance(1 / 30, [20.0], [0.0])
    assert 0 < np.abs(forest.q).max() < 5.0
    assert set(result.report["seconds"]) >= {"intake", "meshing", "sampling", "table"}


def test_a_second_build_uses_what_the_first_has_kept(mesh: bytes, cache: Path) -> None:
    def no_runner(tasks: Sequence[SampleTask], done: Callable[[int], None]) -> list[Path]:
        assert all(task.path.exists() for task in tasks)
        return [task.path for task in tasks]

    build_table(mesh, "tree.glb", OPTIONS, no_runner, cache_dir=cache)


def test_a_stopped_build_goes_on_from_what_is_stored(mesh: bytes, cache: Path) -> None:
    """One run was torn by the stop, one was not made, all others are there."""
    made: list[str] = []

    def told(tasks: Sequence[SampleTask], done: Callable[[int], None]) -> list[Path]:
        made.extend(task.wind.name for task in tasks if not task.path.exists())
        return in_this_process(tasks, done)

    first = build_table(mesh, "tree.glb", OPTIONS, told, cache_dir=cache)
    assert made == []
    runs = sorted((cache / "trajectories").glob("*.npz"))
    runs[3].unlink()
    runs[7].write_bytes(runs[7].read_bytes()[:-100])
    again = build_table(mesh, "tree.glb", OPTIONS, told, cache_dir=cache)
    assert len(made) == 2
    assert again.table == first.table


def test_pictures_and_an_early_table_are_handed_out_on_the_way(mesh: bytes, cache: Path) -> None:
    out: dict[str, bytes] = {}
    left: list[int] = []

    def one_by_one(tasks: Sequence[SampleTask], done: Callable[[int], None]) -> list[Path]:
        for count, task in enumerate(tasks, 1):
            run_task(task)
            done(count)
            if "early.table" in out and not left:
                left.append(len(tasks) - count)
        return [task.path for task in tasks]

    for run in sorted((cache / "trajectories").glob("*.npz")):
        run.unlink()
    result = build_table(mesh, "tree.glb", OPTIONS, one_by_one, cache_dir=cache, publish=out.__setitem__)
    assert set(out) == {"tetrahedra.png", "skeleton.png", "early.table"}
    for name in ("tetrahedra.png", "skeleton.png"):
        assert out[name].startswith(b"\x89PNG")
        assert len(out[name]) <= 200_000
    early, whole = decode(out["early.table"]), decode(result.table)
    assert left[0] > 30
    assert early.metadata["provenance"]["preliminary"] is True
    assert "preliminary" not in whole.metadata["provenance"]
    assert 0 < len(early.dq) < len(whole.dq) / 2
    assert result.report["model"]["reference"]["trajectory_error"] < 0.2


@pytest.mark.parametrize("stage", ["skeleton", "table"])
def test_what_the_progress_raises_stops_the_build(mesh: bytes, cache: Path, stage: str) -> None:
    def stop(progress: Progress) -> None:
        if progress.stage == stage:
            raise Cancelled

    with pytest.raises(Cancelled):
        build_table(mesh, "tree.glb", OPTIONS, in_this_process, stop, cache)


def test_what_is_no_tree_is_refused(cache: Path) -> None:
    with pytest.raises(IntakeError):
        build_table(b"not a mesh at all", "tree.glb", OPTIONS, in_this_process, cache_dir=cache)
