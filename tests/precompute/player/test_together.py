"""Trees of several tables stepped together, against each table's trees stepped alone."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from galewood.constants import MOST_TERM_SUMS
from galewood.motion.modal.term_sums import term_sums
from galewood.motion.wind import Wind, WindField
from galewood.options import Method
from galewood.player import ModalForest, WindDrivenForest, WindDrivenTrees
from galewood.table import Table, decode

from tests.golden import GOLDEN_FOLDER

SHIPPED = Path(__file__).parents[3] / "assets" / "species" / "shipped"


def shipped(name: str) -> Table:
    return decode((SHIPPED / f"{name}.table").read_bytes())


def few_ways(table: Table, ways: int, seed: int) -> Table:
    """A table like that of an individual: its force moves the oscillators in few ways, its pose is sparse."""
    rng = np.random.default_rng(seed)
    force = table.modal_force.astype(np.float64)
    along = np.linalg.svd(force, full_matrices=False)[2][:ways]
    sparse = np.zeros_like(table.modal_pose)
    d = len(table.modal_step)
    sparse[d + 2 : d + 5] = rng.normal(size=(3, sparse.shape[1])) * 0.1
    return replace(table, modal_force=(force @ along.T @ along).astype(np.float32), modal_pose=sparse)


def placed(count: int, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    place = rng.uniform(-60, 60, (count, 2))
    return np.column_stack([place, rng.uniform(0, 6, count), rng.uniform(0.8, 1.2, count)])


def forests(seed: int) -> list[tuple[Table, np.ndarray, Method]]:
    oak, pole = shipped("oak"), decode((GOLDEN_FOLDER / "pole.safetensors").read_bytes())
    tables = [
        oak,
        few_ways(oak, 2, seed),
        few_ways(oak, 2, seed + 1),
        few_ways(oak, 0, seed),
        pole,
        oak,
        pole,
    ]
    counts = [1, 2, 1, 1, 3, 0, 40]
    given = zip(tables, counts, strict=True)
    return [(table, placed(count, seed + k), "modal") for k, (table, count) in enumerate(given)]


def test_trees_of_several_tables_move_as_those_of_each_alone() -> None:
    seed = 8
    print("seed", seed)
    given = forests(seed)
    alone = [WindDrivenTrees(*one) for one in given]
    groups = [WindDrivenTrees(*one) for one in given]
    together = WindDrivenForest(groups)
    winds = [
        Wind(mean_speed_m_s=9.0, gustiness=0.8, seed=3),
        Wind(mean_speed_m_s=30.0, seed=4),
        Wind(mean_speed_m_s=0.0),
    ]
    fields = WindField(winds[0]), WindField(winds[0])
    largest = 0.0
    for frame in range(360):
        time_s = frame / 30
        if frame in (120, 240):
            for field in fields:
                field.change(winds[frame // 120], time_s)
        if frame == 60:
            for one in (*alone, *groups):
                if len(one.q):
                    assert one.displace(0, np.full(dynamic(one), 0.5), np.zeros(dynamic(one)))
        for one in alone:
            one.step(fields[0], time_s, 1 / 40)
        together.step(fields[1], time_s, 1 / 40)
        for one, twin, (table, _, _) in zip(groups, alone, given, strict=True):
            height_m = float(table.metadata["height_m"])
            assert np.array_equal(one.pressure_pa, twin.pressure_pa)
            assert np.allclose(one.q, twin.q, rtol=0.0, atol=1e-6 * height_m), frame
            assert np.allclose(one.extrapolation_ratio, twin.extrapolation_ratio, atol=1e-5)
            assert np.array_equal(one.steps[2], twin.steps[2])
            largest = max(largest, float(np.abs(one.q).max(initial=0.0)) / height_m)
    assert largest > 0.02


def dynamic(trees: WindDrivenTrees) -> int:
    """Oscillators of a tree."""
    forest = trees.forest
    assert isinstance(forest, ModalForest)
    return len(forest.modal.step)


def test_trees_of_the_papers_method_are_stepped_beside_the_others() -> None:
    pole = decode((GOLDEN_FOLDER / "pole.safetensors").read_bytes())
    methods: list[Method] = ["paper", "modal"]
    alone, groups = ([WindDrivenTrees(pole, placed(2, 5), method) for method in methods] for _ in range(2))
    together, fields = WindDrivenForest(groups), (WindField(Wind()), WindField(Wind()))
    for frame in range(60):
        for one in alone:
            one.step(fields[0], frame / 30, 1 / 30)
        together.step(fields[1], frame / 30, 1 / 30)
    assert np.array_equal(groups[0].q, alone[0].q) and np.abs(groups[0].q).max() > 0.0
    assert np.allclose(groups[1].q, alone[1].q, atol=1e-6)


@pytest.mark.parametrize("ways", range(MOST_TERM_SUMS + 2))
def test_few_sums_give_a_force_to_rounding(ways: int) -> None:
    rng = np.random.default_rng(ways)
    print("seed", ways)
    units = 10.0 ** rng.uniform(-12, 4, 44)
    force = (units[:, None] * (rng.normal(size=(44, ways)) @ rng.normal(size=(ways, 24)))).astype(np.float32)
    force[7] = 0.0
    sums = term_sums(force)
    if ways > MOST_TERM_SUMS:
        assert sums is None
        return
    assert sums is not None and len(sums.rows) == ways
    most = np.abs(force).max(axis=1, keepdims=True)
    assert (np.abs(sums.shares.T @ sums.rows - force) <= 2.0**-21 * most).all()
