"""The records of the paper's state search: part of a table, or a separate file that follows later."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from galewood.constants import MAX_MODES, RECORD_TENSORS, RECORDS_FORMAT, RECORDS_VERSION
from galewood.table.container import (
    Layout,
    Metadata,
    TableError,
    check_finite,
    check_format,
    check_shapes,
    fields,
    layout,
    need,
    number,
    read_metadata,
    read_tensors,
    tensors_of,
    whole,
    write,
)
from galewood.util import Array


@dataclass(frozen=True)
class Records:
    """z records of r modes with their candidate lists. Units in spec/formats/table.md."""

    metadata: Metadata
    """records, points, components, sampled_elements, sigma_pa, weight, pose_easing, winds, frames."""
    dq: npt.NDArray[np.int16]  # (z, r) in units of the table's mode_scale
    pressure_pa: npt.NDArray[np.float32]  # (z, 2)
    trajectory: npt.NDArray[np.uint32]  # (trajectories + 1,)
    offsets: npt.NDArray[np.uint32]  # (z + 1,)
    candidate: npt.NDArray[np.uint16]  # (nnz,)
    mismatches: npt.NDArray[np.uint16]  # (nnz,)

    def pose(self) -> npt.NDArray[np.int32]:
        """(z, r) pose of every record, in units of mode_scale; every trajectory starts at 0."""
        before = np.cumsum(self.dq, axis=0, dtype=np.int64) - self.dq
        lengths = np.diff(self.trajectory.astype(np.int64))
        before -= np.repeat(before[self.trajectory[:-1].astype(np.int64)], lengths, axis=0)
        return before.astype(np.int32)


RECORDS_LAYOUT: Layout = layout(
    RECORD_TENSORS,
    {
        "samples.dq": "dq",
        "samples.pressure_pa": "pressure_pa",
        "samples.trajectory": "trajectory",
        "search.offsets": "offsets",
        "search.record": "candidate",
        "search.mismatch_steps": "mismatches",
    },
)


def encode_records(records: Records, table_sha256: str) -> bytes:
    """Encode records as a file that belongs to the table with this hash. Raises TableError."""
    modes = records.dq.shape[1]
    check_records(records, modes)
    header = {
        "format": RECORDS_FORMAT,
        "version": RECORDS_VERSION,
        "table_sha256": table_sha256,
        "modes": modes,
    }
    return write(record_tensors(records), {**header, "paper": records.metadata})


def decode_records(data: bytes) -> tuple[Records, str]:
    """The records of a file, and the hash of the table they belong to. Raises TableError."""
    metadata = read_metadata(data)
    check_format(metadata, RECORDS_FORMAT, RECORDS_VERSION)
    table_sha256 = metadata.get("table_sha256")
    if not isinstance(table_sha256, str):
        raise TableError("metadata table_sha256: expected a string")
    tensors = read_tensors(data)
    extra = set(tensors) - set(RECORDS_LAYOUT)
    if extra:
        raise TableError(f"unknown tensor {sorted(extra)[0]:.60}")
    return read_records(metadata.get("paper"), tensors, whole(metadata, "modes", MAX_MODES)), table_sha256


def record_tensors(records: Records) -> dict[str, Array]:
    """The tensors of the records as they are stored."""
    tensors = tensors_of(records, RECORDS_LAYOUT)
    tensors["search.mismatch_steps"] = _differences(records.mismatches, records.offsets)
    return tensors


def read_records(metadata: object, tensors: dict[str, Array], modes: int) -> Records:
    """The records from their metadata and stored tensors. Raises TableError."""
    if not isinstance(metadata, dict):
        raise TableError("metadata paper: expected an object")
    _check_metadata(metadata)
    records = Records(metadata, **fields(tensors, RECORDS_LAYOUT))
    _check_shapes(records, modes)
    _check_offsets(records)
    records = replace(records, mismatches=_sums(records.mismatches, records.offsets))
    check_records(records, modes)
    return records


def check_records(records: Records, modes: int) -> None:
    """Raise TableError unless the records conform to the format."""
    _check_metadata(records.metadata)
    _check_shapes(records, modes)
    check_finite(records, RECORDS_LAYOUT)
    _check_trajectories(records)
    _check_search(records)


def _differences(mismatches: Array, offsets: Array) -> npt.NDArray[np.uint16]:
    """Differences of the mismatches within each row of candidates; the first of a row is kept."""
    steps = np.diff(mismatches, prepend=np.uint16(0))
    first = offsets[:-1].astype(np.int64)
    steps[first] = mismatches[first]
    return steps


def _sums(steps: Array, offsets: Array) -> npt.NDArray[np.uint16]:
    """Inverse of ``_differences``. An overflow means unsorted candidates: raises TableError."""
    sums = np.cumsum(steps, dtype=np.int64)
    first = offsets[:-1].astype(np.int64)
    sums -= np.repeat(sums[first] - steps[first], np.diff(offsets.astype(np.int64)))
    need(int(sums.max()) <= 65535, "tensor search.mismatch_steps: out of range")
    return sums.astype(np.uint16)


def _check_metadata(metadata: Metadata) -> None:
    number(metadata, "sigma_pa", 1e-9, 1e9)
    number(metadata, "pose_easing", 0.0, 1.0)
    for name in ("records", "points", "components"):
        whole(metadata, name, 65535)
    need(isinstance(metadata.get("weight"), dict), "metadata weight: expected an object")
    initial = number(metadata["weight"], "initial", 0.0, 0.999)
    number(metadata["weight"], "maximum", initial, 0.999)
    number(metadata["weight"], "growth", 0.0, 1.0)


def _check_shapes(records: Records, modes: int) -> None:
    z = int(records.metadata["records"])
    expected = {
        "samples.dq": (z, modes),
        "samples.pressure_pa": (z, 2),
        "search.offsets": (z + 1,),
        "search.mismatch_steps": (len(records.candidate),),
    }
    check_shapes(records, RECORDS_LAYOUT, expected)


def _check_trajectories(records: Records) -> None:
    starts = records.trajectory.astype(np.int64)
    ends = len(starts) >= 2 and starts[0] == 0 and starts[-1] == len(records.dq)
    need(bool(ends), "tensor samples.trajectory: must run from 0 to the number of records")
    # A trajectory of one record is never found: its only record has no successor.
    need(bool((np.diff(starts) >= 2).all()), "tensor samples.trajectory: every trajectory needs two records")
    worst = math.prod([int(np.diff(starts).max()), 32768])
    need(worst < 2**31, "tensor samples.trajectory: a trajectory is too long")


def _check_offsets(records: Records) -> None:
    offsets, nnz = records.offsets.astype(np.int64), len(records.candidate)
    need(bool(offsets[0] == 0 and offsets[-1] == nnz), "tensor search.offsets: must run from 0 to the end")
    need(bool((np.diff(offsets) >= 1).all()), "tensor search.offsets: every record needs a candidate")


def _check_search(records: Records) -> None:
    _check_offsets(records)
    offsets, z, nnz = records.offsets.astype(np.int64), len(records.dq), len(records.candidate)
    candidate = records.candidate.astype(np.int64)
    last = np.zeros(65536, np.bool_)
    last[z:] = True
    last[records.trajectory[1:].astype(np.int64) - 1] = True
    need(not last[candidate].any(), "tensor search.record: out of range, or the last of its trajectory")
    mismatches = records.mismatches.astype(np.int64)
    need(
        int(mismatches.max()) <= int(records.metadata["components"]),
        "tensor search.mismatch_steps: out of range",
    )
    key = mismatches * 65536 + candidate
    first = np.zeros(nnz, np.bool_)
    first[offsets[:-1]] = True
    need(bool(((np.diff(key) > 0) | first[1:]).all()), "tensor search.record: candidates out of order")
