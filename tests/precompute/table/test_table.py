"""The table file: lossless round trip, and refusal of invalid files."""

import hashlib
import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from galewood.table import decode, encode, encode_records, with_records
from galewood.table.container import TableError, read_metadata
from galewood.table.format import TABLE_LAYOUT, Table
from galewood.table.records import RECORDS_LAYOUT, decode_records
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from safetensors.numpy import load, save

from tests.golden import GOLDEN_FOLDER

FILE = (GOLDEN_FOLDER / "pole.safetensors").read_bytes()
ALONE, RECORDS = ((GOLDEN_FOLDER / f"pole-{name}.safetensors").read_bytes() for name in ("table", "records"))
TABLE = decode(FILE)
FIELDS = TABLE_LAYOUT | RECORDS_LAYOUT


def value(table: Table, name: str) -> Any:
    return getattr(table if name in TABLE_LAYOUT else table.records, FIELDS[name][0])


def changed(name: str, values: np.ndarray) -> Table:
    field = FIELDS[name][0]
    if name in TABLE_LAYOUT:
        return replace(TABLE, **{field: values})
    return replace(TABLE, paper=replace(TABLE.records, **{field: values}))


def rewritten(
    metadata: dict[str, object] | None = None,
    paper: dict[str, object] | None = None,
    **tensors: np.ndarray | None,
) -> bytes:
    content = {**load(FILE), **{name.replace("__", "."): tensor for name, tensor in tensors.items()}}
    whole = TABLE.metadata | {"paper": TABLE.records.metadata | (paper or {})}
    text = json.dumps(whole | (metadata or {}))
    return save({name: tensor for name, tensor in content.items() if tensor is not None}, {"galewood": text})


def test_the_round_trip_is_bit_identical() -> None:
    assert encode(TABLE) == FILE
    again = decode(encode(TABLE))
    for name, (_, dtype, _) in FIELDS.items():
        assert value(again, name).dtype == dtype
        assert np.array_equal(value(again, name), value(TABLE, name))


def test_poses_are_prefix_sums_within_each_trajectory() -> None:
    records = TABLE.records
    pose = records.pose()
    for start, end in zip(records.trajectory[:-1], records.trajectory[1:], strict=True):
        assert not pose[start].any()
        for i in range(int(start), int(end) - 1):
            assert np.array_equal(pose[i + 1], pose[i] + records.dq[i])


@pytest.mark.parametrize("share", [0.0, 1e-5, 1e-3, 0.3, 0.999])
def test_refuses_truncated_files(share: float) -> None:
    with pytest.raises(TableError):
        decode(FILE[: int(share * len(FILE))])


def test_a_table_is_in_leaf_unless_it_says_otherwise() -> None:
    given: list[dict[str, object]] = [{}, {"foliage": "leaf"}, {"foliage": "bare"}]
    found = [decode(rewritten(more)).foliage for more in given]
    assert found == ["leaf", "leaf", "bare"]


@pytest.mark.parametrize("version", [0, 2, 10, "1", True, None])
def test_refuses_another_version_naming_both(version: object) -> None:
    with pytest.raises(TableError, match=f"table version {version!r}; this reader knows version 1"):
        decode(rewritten({"version": version}))


@pytest.mark.parametrize(
    "metadata",
    [
        {"format": "else"},
        {"modes": 0},
        {"primitives": []},
        {"reach_m": None},
        {"peak_pressure_pa": -1.0},
        {"streamlined_exponent": None},
        {"streamlined_exponent": 0.99},
        {"streamlined_exponent": 2.01},
        {"foliage": "needles"},
        {"paper": None},
        {"paper": []},
    ],
)
def test_refuses_invalid_metadata(metadata: dict[str, object]) -> None:
    with pytest.raises(TableError):
        decode(rewritten(metadata))


@pytest.mark.parametrize(
    "paper",
    [
        {"records": 12},
        {"sigma_pa": float("nan")},
        {"weight": {"initial": 0.5, "maximum": 0.4, "growth": 0.1}},
        {"weight": {"initial": 0.5, "maximum": 1.0, "growth": 0.1}},
        {"pose_easing": True},
    ],
)
def test_refuses_invalid_metadata_of_the_records(paper: dict[str, object]) -> None:
    with pytest.raises(TableError):
        decode(rewritten(paper=paper))


def test_a_table_without_records_says_so() -> None:
    table = decode(ALONE)
    assert table.paper is None
    assert encode(table) == ALONE
    with pytest.raises(TableError, match="no records of the paper's state search"):
        _ = table.records


def test_records_of_their_own_file_belong_to_one_table() -> None:
    sha256 = hashlib.sha256(ALONE).hexdigest()
    records, belongs_to = decode_records(RECORDS)
    assert belongs_to == sha256
    assert encode_records(records, sha256) == RECORDS
    assert encode(with_records(decode(ALONE), RECORDS, sha256)) == FILE
    with pytest.raises(TableError, match="another table"):
        decode(ALONE, encode_records(records, "0" * 64))
    with pytest.raises(TableError, match=r"samples\.dq"):
        narrow = replace(records, dq=np.ascontiguousarray(records.dq[:, :-1]))
        decode(ALONE, encode_records(narrow, sha256))


@pytest.mark.parametrize("part", [ALONE, RECORDS])
def test_a_table_is_not_a_records_file(part: bytes) -> None:
    wrong = decode_records if part is ALONE else decode
    with pytest.raises(TableError, match="not a galewood-"):
        wrong(part)


@pytest.mark.parametrize("share", [0.0, 1e-3, 0.3, 0.999])
def test_refuses_truncated_records(share: float) -> None:
    with pytest.raises(TableError):
        decode_records(RECORDS[: int(share * len(RECORDS))])


def test_refuses_records_of_another_version() -> None:
    text = json.dumps(read_metadata(RECORDS) | {"version": 2})
    with pytest.raises(TableError, match="records version 2; this reader knows version 1"):
        decode_records(save(load(RECORDS), {"galewood": text}))


def test_refuses_missing_unknown_and_mistyped_tensors() -> None:
    with pytest.raises(TableError, match=r"missing tensor samples\.dq"):
        decode(rewritten(samples__dq=None))
    with pytest.raises(TableError, match=r"unknown tensor samples\.more"):
        decode(rewritten(samples__more=TABLE.records.dq))
    with pytest.raises(TableError, match=r"samples\.dq: expected int16"):
        decode(rewritten(samples__dq=TABLE.records.dq.astype(np.int32)))


@pytest.mark.parametrize("name", ["modes.scale", "nodes.basis", "nodes.rest_m", "samples.pressure_pa"])
def test_refuses_non_finite_numbers(name: str) -> None:
    values = value(TABLE, name).copy()
    values.flat[0] = np.inf
    with pytest.raises(TableError, match=name):
        encode(changed(name, values))


def test_refuses_a_sampled_range_without_all_coupled_speeds() -> None:
    limits = TABLE.modal_limits[:-1].copy()
    with pytest.raises(TableError, match=r"modal\.limits: expected 3, 5, … 9 numbers"):
        encode(changed("modal.limits", limits))


@pytest.mark.parametrize(
    ("name", "place", "number"),
    [
        ("render.vertex_joint", 0, 60000),
        ("joints.nodes", (0, 1), 60000),
        ("joints.share", 0, 1.5),
        ("nodes.parent", 0, 1),
        ("search.record", 5, 60000),
        ("search.record", 0, int(TABLE.records.trajectory[1]) - 1),
        ("search.mismatch_steps", -1, 60000),
        ("search.offsets", 1, 0),
        ("search.offsets", -1, 3),
        ("samples.trajectory", 1, 1),
        ("samples.trajectory", -1, 9),
    ],
)
def test_refuses_indices_out_of_range(name: str, place: int | tuple[int, int], number: float) -> None:
    values = value(TABLE, name).copy()
    values[place] = number
    with pytest.raises(TableError, match=name.split(".")[0]):
        encode(changed(name, values))


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=True)
@given(st.binary(min_size=1, max_size=400))
def test_random_bytes_are_refused(data: bytes) -> None:
    for content in (data, FILE[: len(FILE) // 2] + data, data + FILE):
        with pytest.raises(TableError):
            decode(content)
