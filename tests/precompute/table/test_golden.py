"""The golden table, made again and compared, and the same table as two files.

The sign of every eigenvector (and the rotation of those that share an eigenvalue) is the platform's choice.
What is compared is therefore what does not depend on it: displacements, frequencies, damping, candidates.
"""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from galewood.table.format import TABLE_LAYOUT, Table, decode, encode
from galewood.table.records import RECORDS_LAYOUT

from tests.golden import GOLDEN_FOLDER
from tests.golden.make import beam_table, sway_steps

STORED, ALONE, RECORDS = (GOLDEN_FOLDER / f"pole{name}.safetensors" for name in ("", "-table", "-records"))
INVARIANT = ("mode_scale", "node_rest_m", "vertex_joint", "joint_nodes", "joint_rest_m", "modal_limits")
INVARIANT_RECORDS = ("pressure_pa", "trajectory", "offsets")


@cache
def stored() -> Table:
    return decode(STORED.read_bytes())


@cache
def regenerated() -> Table:
    return decode(encode(beam_table()))


def nodes(table: Table, poses: list[list[float]]) -> np.ndarray:
    """(T, trees, n, 3) m of the poses that `sway_steps` or its file holds."""
    q = np.array(poses).reshape(len(poses), -1, len(table.mode_scale))
    return np.einsum("nir,tcr->tcni", table.node_basis.astype(np.float64), q)


def sampled(table: Table) -> np.ndarray:
    """(z, n, 3) m of every record's pose."""
    q = table.recorded_q_m
    return np.einsum("nir,zr->zni", table.node_basis.astype(np.float64), q)


def poles(table: Table) -> tuple[np.ndarray, np.ndarray]:
    """Frequency (Hz) and damping ratio of every oscillator of the modal model, from its step matrix."""
    step, dt_s = table.modal_step.astype(np.float64), float(table.metadata["dt_s"])
    matrices = np.eye(2) + step[:, :4].reshape(-1, 2, 2)
    rate = np.log(np.linalg.eigvals(matrices)[:, 0].astype(complex)) / dt_s
    return np.abs(rate) / (2 * np.pi), -rate.real / np.abs(rate)


@pytest.mark.timeout(1200)
def test_the_stored_table_is_what_the_code_makes() -> None:
    old, new = stored(), regenerated()
    rounded = {"errors", "reach_m"}  # the last digits depend on the BLAS library and its threads
    assert {name: old.metadata[name] for name in old.metadata if name not in rounded} == {
        name: new.metadata[name] for name in new.metadata if name not in rounded
    }
    assert new.metadata["reach_m"] == pytest.approx(old.metadata["reach_m"], rel=1e-9)
    for name, value in old.metadata["errors"].items():
        assert new.metadata["errors"][name] == pytest.approx(value, rel=1e-3, abs=1e-9), name
    assert new.records.metadata == old.records.metadata
    pairs = [(name, getattr(old, name), getattr(new, name)) for name in INVARIANT]
    pairs += [(name, getattr(old.records, name), getattr(new.records, name)) for name in INVARIANT_RECORDS]
    for name, first, second in pairs:
        assert first.shape == second.shape, name
        np.testing.assert_allclose(second.astype(np.float64), first, rtol=1e-5, atol=1e-7, err_msg=name)
    assert np.abs(sampled(new) - sampled(old)).max() < 1e-4 * np.abs(sampled(old)).max()
    np.testing.assert_allclose(poles(new), poles(old), rtol=1e-4)
    np.testing.assert_allclose(np.abs(new.modal_load), np.abs(old.modal_load), rtol=1e-4, atol=1e-6)


@pytest.mark.timeout(1200)
def test_the_regenerated_table_sways_as_the_golden_motion_does() -> None:
    golden = json.loads((GOLDEN_FOLDER / "sway.json").read_text())
    expected = nodes(stored(), golden["poses"])
    assert np.abs(expected).max() > 0.3
    found = nodes(regenerated(), sway_steps(regenerated())["poses"])
    assert np.abs(found - expected).max() < 1e-5 * np.abs(expected).max()


def test_a_wrong_coefficient_is_found_by_these_comparisons() -> None:
    wrong = replace(stored(), modal_load=np.float32(1.001) * stored().modal_load)
    golden = nodes(stored(), json.loads((GOLDEN_FOLDER / "sway.json").read_text())["poses"])
    found = nodes(wrong, sway_steps(wrong)["poses"])
    assert np.abs(found - golden).max() > 1e-4 * np.abs(golden).max()


def test_the_records_may_come_in_a_file_of_their_own() -> None:
    alone, records = ALONE.read_bytes(), RECORDS.read_bytes()
    assert decode(alone).paper is None
    same_tensors(decode(alone, records), stored())
    assert encode(decode(alone, records)) == STORED.read_bytes()


def same_tensors(one: Table, other: Table) -> None:
    for field, _, _ in TABLE_LAYOUT.values():
        assert np.array_equal(getattr(one, field), getattr(other, field)), field
    for field, _, _ in RECORDS_LAYOUT.values():
        assert np.array_equal(getattr(one.records, field), getattr(other.records, field)), field
