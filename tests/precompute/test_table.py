"""The table file: lossless round trip, and refusal of invalid files."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from galewood.table.format import TENSORS, Table, TableError, decode, encode
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from safetensors.numpy import load, save

FILE = (Path(__file__).parents[1] / "golden" / "pole.safetensors").read_bytes()
TABLE = decode(FILE)


def changed(name: str, values: np.ndarray) -> Table:
    return replace(TABLE, **{TENSORS[name][0]: values})


def rewritten(metadata: dict[str, object] | None = None, **tensors: np.ndarray | None) -> bytes:
    content = {**load(FILE), **{name.replace("__", "."): value for name, value in tensors.items()}}
    text = json.dumps(TABLE.metadata | (metadata or {}))
    return save({name: value for name, value in content.items() if value is not None}, {"galewood": text})


def test_the_round_trip_is_bit_identical() -> None:
    assert encode(TABLE) == FILE
    again = decode(encode(TABLE))
    for field, dtype, _ in TENSORS.values():
        assert getattr(again, field).dtype == dtype
        assert np.array_equal(getattr(again, field), getattr(TABLE, field))


def test_poses_are_prefix_sums_within_each_trajectory() -> None:
    pose = TABLE.pose()
    for start, end in zip(TABLE.trajectory[:-1], TABLE.trajectory[1:], strict=True):
        assert not pose[start].any()
        for i in range(int(start), int(end) - 1):
            assert np.array_equal(pose[i + 1], pose[i] + TABLE.dq[i])


@pytest.mark.parametrize("share", [0.0, 1e-5, 1e-3, 0.3, 0.999])
def test_refuses_truncated_files(share: float) -> None:
    with pytest.raises(TableError):
        decode(FILE[: int(share * len(FILE))])


def test_refuses_another_version_naming_both() -> None:
    with pytest.raises(TableError, match="version 7; this reader knows versions 5 and 6"):
        decode(rewritten({"version": 7}))


@pytest.mark.parametrize(
    "metadata",
    [
        {"format": "else"},
        {"records": 12},
        {"modes": 0},
        {"sigma_pa": float("nan")},
        {"weight": {"initial": 0.5, "maximum": 0.4, "growth": 0.1}},
        {"weight": {"initial": 0.5, "maximum": 1.0, "growth": 0.1}},
        {"primitives": []},
        {"pose_easing": True},
    ],
)
def test_refuses_invalid_metadata(metadata: dict[str, object]) -> None:
    with pytest.raises(TableError):
        decode(rewritten(metadata))


def test_refuses_missing_unknown_and_mistyped_tensors() -> None:
    with pytest.raises(TableError, match=r"missing tensor samples\.dq"):
        decode(rewritten(samples__dq=None))
    with pytest.raises(TableError, match=r"unknown tensor samples\.more"):
        decode(rewritten(samples__more=TABLE.dq))
    with pytest.raises(TableError, match=r"samples\.dq: expected int16"):
        decode(rewritten(samples__dq=TABLE.dq.astype(np.int32)))


@pytest.mark.parametrize("name", ["modes.scale", "nodes.basis", "nodes.rest_m", "samples.pressure_pa"])
def test_refuses_non_finite_numbers(name: str) -> None:
    values = getattr(TABLE, TENSORS[name][0]).copy()
    values.flat[0] = np.inf
    with pytest.raises(TableError, match=name):
        encode(changed(name, values))


def test_refuses_a_sampled_range_without_all_coupled_speeds() -> None:
    limits = TABLE.modal_limits[:-1].copy()
    with pytest.raises(TableError, match=r"modal\.limits: expected 3, 5, … 9 numbers"):
        encode(changed("modal.limits", limits))


@pytest.mark.parametrize(
    ("name", "place", "value"),
    [
        ("render.vertex_node", 0, 60000),
        ("search.record", 5, 60000),
        ("search.record", 0, int(TABLE.trajectory[1]) - 1),
        ("search.mismatch_steps", -1, 60000),
        ("search.offsets", 1, 0),
        ("search.offsets", -1, 3),
        ("samples.trajectory", 1, 1),
        ("samples.trajectory", -1, 9),
    ],
)
def test_refuses_indices_out_of_range(name: str, place: int, value: int) -> None:
    values = getattr(TABLE, TENSORS[name][0]).copy()
    values[place] = value
    with pytest.raises(TableError, match=name.split(".")[0]):
        encode(changed(name, values))


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=True)
@given(st.binary(min_size=1, max_size=400))
def test_random_bytes_are_refused(data: bytes) -> None:
    for content in (data, FILE[: len(FILE) // 2] + data, data + FILE):
        with pytest.raises(TableError):
            decode(content)
