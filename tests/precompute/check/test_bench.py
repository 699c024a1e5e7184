"""The benchmark's own arithmetic, on a small table; that nothing here is slow or fast is not tested."""

import sys
from typing import Any

import numpy as np
import pytest
from galewood.check.bench import rivals
from galewood.check.bench import tables as bench_tables
from galewood.check.bench.fem import bench_fem, compared
from galewood.check.bench.report import SENTENCES, sentences
from galewood.check.bench.run import PARTS, chosen_parts
from galewood.check.bench.tables import bench_forest, sizes
from galewood.check.bench.waiting import ratios, solve_s
from galewood.check.verify.bars import polygon_bar
from galewood.solid.fem.model import FemModel, FemSettings
from galewood.solid.model.construction import build_model
from galewood.table.format import decode
from galewood.util import Floats
from galewood.wood.species import wood_of_species

from tests.golden import GOLDEN_FOLDER

GOLDEN = GOLDEN_FOLDER / "pole.safetensors"


def test_bytes_of_a_table_beside_the_papers_displacements() -> None:
    data = GOLDEN.read_bytes()
    figures = sizes(decode(data), data, 1000)
    assert figures["raw_displacement_bytes"] == figures["records"] * 1000 * 12
    assert figures["zstd_bytes"] < figures["bytes"] == len(data)
    assert figures["deflated_bytes"] < figures["bytes"]


def test_a_forest_is_stepped_by_both_methods(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bench_tables, "FOREST_TREES", 20)
    figures = bench_forest(decode(GOLDEN.read_bytes()))
    assert figures["trees"] == 20
    for method in ("modal", "paper"):
        assert figures[method]["ms"] == pytest.approx(figures[method]["us_per_tree"] * 20 / 1e3)
        assert figures[method]["ms"] > 0
    assert "20 trees" in sentences({"modal": figures})[0]


def test_every_part_has_its_sentences() -> None:
    assert set(SENTENCES) == set(PARTS)
    samples = {
        "samples": 6480, "tree": "poplar", "fast_cpu_s": 14.2, "fast_samples_run": 540,
        "reference_cpu_s": 400.0, "reference_samples_run": 20, "faster": 28.2,
    }  # fmt: skip
    first, second = sentences({"samples": samples})
    assert "6,480 samples of poplar: 14.2 CPU seconds with the fast elements (540 simulated)" in first
    assert "400 CPU seconds (20 simulated)" in second


def test_waiting_is_measured_in_times_of_other_work() -> None:
    assert ratios({"read": 0.6, "first_motion": 1.5}, 0.3) == {"read_ratio": 2.0, "first_motion_ratio": 5.0}
    assert solve_s(small_model(), 0) == 0.0
    model = small_model()
    assert solve_s(model, 100) > 0
    figures = {
        "tree": "maple", "read_cpu_s": 0.6, "first_motion_cpu_s": 1.5, "read_ratio": 2.0,
        "first_motion_ratio": 5.0,
    }  # fmt: skip
    assert "2.0 times those of trimesh; with its first motion 1.50, 5.0" in sentences({"upload": figures})[0]


def small_model() -> FemModel:
    bar = polygon_bar(sides=5, radius_m=0.05, length_m=3.0, layers=12, tip_radius_m=0.02)
    return build_model(bar, bar, wood_of_species("maple"), bar, FemSettings(element="linear"))


def test_every_rival_solves_the_same_system_as_the_own_solver() -> None:
    figures = bench_fem(small_model(), np.arange(5, dtype=np.int32), steps=2)
    assert figures["missing_rivals"] == []
    assert set(figures["rivals"]) == set(rivals.RIVALS)
    assert figures["strongest_rival"] in rivals.RIVALS
    lines = sentences({"fem": figures})
    for name in rivals.RIVALS:
        assert sum(f"with {name}" in line for line in lines) >= 1


def test_a_rival_with_another_solution_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    class Wrong(rivals.Splu):
        def solve(self, prepared: Any, b: Floats) -> Floats:
            return (1 + 1e-7) * super().solve(prepared, b)

    monkeypatch.setitem(rivals.RIVALS, "wrong", lambda matrix: Wrong(matrix, "NATURAL"))
    with pytest.raises(RuntimeError, match="solution by wrong differs"):
        bench_fem(small_model(), np.arange(5, dtype=np.int32), steps=1)


def test_rivals_that_are_not_installed_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in ("qdldl", "cvxopt", "cvxopt.cholmod"):
        monkeypatch.setitem(sys.modules, module, None)
    figures = bench_fem(small_model(), np.arange(5, dtype=np.int32), steps=1)
    assert figures["missing_rivals"] == ["QDLDL", "CHOLMOD"]
    assert "QDLDL, CHOLMOD" in sentences({"fem": figures})[-1]


def test_ratios_of_a_rival_are_to_the_own_solver_and_to_the_whole_step() -> None:
    figures = compared(2.0, 0.5, {"slow": 4.0, "fast": 1.0})
    assert figures["strongest_rival"] == "fast"
    assert figures["rivals"]["slow"] == {
        "factorisation_and_solve_ms": 4.0, "factorisation_and_solve_ratio": 8.0,
        "step_ms": 5.5, "step_ratio": 2.75,
    }  # fmt: skip


def test_parts_are_run_in_order() -> None:
    assert chosen_parts(["wind", "modal"]) == ["modal", "wind"]
    assert chosen_parts([]) == list(PARTS)
    with pytest.raises(ValueError, match="unknown part 'speed'; choose from fem"):
        chosen_parts(["speed"])
