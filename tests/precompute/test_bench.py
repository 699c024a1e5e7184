"""The benchmark's own arithmetic, on a small table; that nothing here is slow or fast is not tested."""

from pathlib import Path

import pytest
from galewood.bench import tables as bench_tables
from galewood.bench.report import SENTENCES, sentences
from galewood.bench.run import PARTS
from galewood.bench.tables import bench_forest, sizes
from galewood.table.format import decode

GOLDEN = Path(__file__).parents[1] / "golden" / "pole.safetensors"


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


def test_every_part_is_told_in_words() -> None:
    assert set(SENTENCES) == set(PARTS)
    samples = {
        "samples": 6480, "tree": "poplar", "fast_cpu_s": 14.2, "fast_samples_run": 540,
        "reference_cpu_s": 400.0, "reference_samples_run": 20, "faster": 28.2,
    }  # fmt: skip
    first, second = sentences({"samples": samples})
    assert "6,480 samples of poplar: 14.2 CPU seconds (540 were run)" in first
    assert "400 CPU seconds (20 were run)" in second
