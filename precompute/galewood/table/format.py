"""The table format: one safetensors file per species (docs/formats/table.md).
Twin: web/src/core/table/table.ts.

``decode`` checks everything that readers rely on, so that a decoded table can be searched without bounds
checks.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt
from safetensors import SafetensorError
from safetensors.numpy import load, save

from galewood.modal import ModalTensors, force_terms, shape_terms
from galewood.util import Array

FORMAT = "galewood-table"
VERSION = 6
READABLE = (5, 6)
"""Version 5 differs only in names: its modal tensors are tangent.*, its training error is errors.replay_m."""
MAX_HEADER_BYTES = 1 << 20
MAX_DYNAMIC = 64

Metadata = dict[str, Any]


class TableError(ValueError):
    """The file is not a valid table; the message says what is wrong."""


@dataclass(frozen=True)
class Table:
    """A decoded table: r modes, z records, n nodes, v render vertices. Units in docs/formats/table.md."""

    metadata: Metadata
    mode_scale: npt.NDArray[np.float32]  # (r,)
    node_basis: npt.NDArray[np.float32]  # (n, 3, r) m per unit of q
    node_rest_m: npt.NDArray[np.float32]  # (n, 3)
    vertex_node: npt.NDArray[np.uint16]  # (v,)
    dq: npt.NDArray[np.int16]  # (z, r) in units of mode_scale
    pressure_pa: npt.NDArray[np.float32]  # (z, 2)
    trajectory: npt.NDArray[np.uint32]  # (trajectories + 1,)
    offsets: npt.NDArray[np.uint32]  # (z + 1,)
    candidate: npt.NDArray[np.uint16]  # (nnz,)
    mismatches: npt.NDArray[np.uint16]  # (nnz,)
    modal_step: npt.NDArray[np.float32]  # (d, 6); modal_*: see galewood.modal.ModalTensors
    modal_load: npt.NDArray[np.float32]  # (d, 2)
    modal_sway: npt.NDArray[np.float32]  # (2, d)
    modal_force: npt.NDArray[np.float32]  # (44 + 6c, d)
    modal_shown: npt.NDArray[np.float32]  # (d,)
    modal_pose: npt.NDArray[np.float32]  # (d + 9 + 2c, r - d)
    modal_limits: npt.NDArray[np.float32]  # (3 + 2c,)

    @property
    def modal(self) -> ModalTensors:
        """Tensors of the modal model."""
        return ModalTensors(
            self.modal_step, self.modal_load, self.modal_sway,
            self.modal_force, self.modal_shown, self.modal_pose, self.modal_limits,
        )  # fmt: skip

    def pose(self) -> npt.NDArray[np.int32]:
        """(z, r) pose of every record, in units of mode_scale; every trajectory starts at 0."""
        return poses(self.dq, self.trajectory)


TENSORS: dict[str, tuple[str, Any, int]] = {
    "modes.scale": ("mode_scale", np.float32, 1),
    "nodes.basis": ("node_basis", np.float32, 3),
    "nodes.rest_m": ("node_rest_m", np.float32, 2),
    "render.vertex_node": ("vertex_node", np.uint16, 1),
    "samples.dq": ("dq", np.int16, 2),
    "samples.pressure_pa": ("pressure_pa", np.float32, 2),
    "samples.trajectory": ("trajectory", np.uint32, 1),
    "search.offsets": ("offsets", np.uint32, 1),
    "search.record": ("candidate", np.uint16, 1),
    "search.mismatch_steps": ("mismatches", np.uint16, 1),
    "modal.step": ("modal_step", np.float32, 2),
    "modal.load": ("modal_load", np.float32, 2),
    "modal.sway": ("modal_sway", np.float32, 2),
    "modal.force": ("modal_force", np.float32, 2),
    "modal.shown": ("modal_shown", np.float32, 1),
    "modal.pose": ("modal_pose", np.float32, 2),
    "modal.limits": ("modal_limits", np.float32, 1),
}
"""Name in the file → (field of Table, type, rank)."""


def poses(dq: Array, trajectory: Array) -> npt.NDArray[np.int32]:
    """(z, r) exclusive prefix sums of dq (z, r) within each trajectory."""
    before = np.cumsum(dq, axis=0, dtype=np.int64) - dq
    starts = trajectory[:-1].astype(np.int64)
    before -= np.repeat(before[starts], np.diff(trajectory.astype(np.int64)), axis=0)
    return before.astype(np.int32)


def encode(table: Table) -> bytes:
    """Encode a table. Raises TableError for a table that ``decode`` would refuse."""
    check(table)
    tensors = {
        name: np.ascontiguousarray(getattr(table, field), dtype)
        for name, (field, dtype, _) in TENSORS.items()
    }
    tensors["search.mismatch_steps"] = _differences(table.mismatches, table.offsets)
    return save(tensors, {"galewood": json.dumps(table.metadata, allow_nan=False, separators=(",", ":"))})


def decode(data: bytes) -> Table:
    """Decode the bytes of a table file. Raises TableError."""
    metadata = read_metadata(data)
    try:
        tensors = load(data)
    except (SafetensorError, ValueError, TypeError, KeyError) as error:
        raise TableError(f"damaged table file: {error}") from error
    if metadata.get("version") == 5:
        metadata, tensors = _from_version_5(metadata, tensors)
    table = Table(
        metadata=metadata, **{field: _tensor(tensors, name) for name, (field, _, _) in TENSORS.items()}
    )
    extra = set(tensors) - set(TENSORS)
    if extra:
        raise TableError(f"unknown tensor {sorted(extra)[0]:.60}")
    check_metadata(table.metadata)
    _check_shapes(table)
    _check_offsets(table)
    table = replace(table, mismatches=_sums(table.mismatches, table.offsets))
    check(table)
    return table


def _from_version_5(metadata: Metadata, tensors: dict[str, Array]) -> tuple[Metadata, dict[str, Array]]:
    """Rename the metadata and tensors of version 5 to those of this version."""
    errors = metadata.get("errors")
    if isinstance(errors, dict) and "replay_m" in errors:
        kept = {name: value for name, value in errors.items() if name != "replay_m"}
        metadata = {**metadata, "errors": {**kept, "training_m": errors["replay_m"]}}
    renamed = {name.replace("tangent.", "modal.", 1): tensor for name, tensor in tensors.items()}
    return {**metadata, "version": VERSION}, renamed


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
    _need(int(sums.max()) <= 65535, "tensor search.mismatch_steps: out of range")
    return sums.astype(np.uint16)


def read_metadata(data: bytes) -> Metadata:
    """Read the metadata of a file without checking it, for any version. Raises TableError."""
    if len(data) < 8:
        raise TableError("truncated table file: no header")
    length = int.from_bytes(data[:8], "little")
    if length > MAX_HEADER_BYTES or 8 + length > len(data):
        raise TableError("truncated table file, or not a table: the header does not fit")
    try:
        header = json.loads(data[8 : 8 + length])
        metadata = json.loads(header["__metadata__"]["galewood"])
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise TableError("not a galewood table: no readable metadata") from error
    if not isinstance(metadata, dict):
        raise TableError("not a galewood table: metadata is not an object")
    return metadata


def _tensor(tensors: dict[str, Array], name: str) -> Array:
    _, dtype, rank = TENSORS[name]
    if name not in tensors:
        raise TableError(f"missing tensor {name}")
    tensor = tensors[name]
    if tensor.dtype != dtype or tensor.ndim != rank:
        raise TableError(f"tensor {name}: expected {np.dtype(dtype).name} of rank {rank}")
    return tensor


def check(table: Table) -> None:
    """Raise TableError unless the table conforms to the format."""
    check_metadata(table.metadata)
    _check_shapes(table)
    _check_numbers(table)
    _check_trajectories(table)
    _check_search(table)
    _check_modal(table)


def _need(holds: bool, complaint: str) -> None:
    if not holds:
        raise TableError(complaint)


def check_metadata(metadata: Metadata) -> None:
    """Check format, version and all numbers that readers use. Raises TableError."""
    _need(metadata.get("format") == FORMAT, f"not a {FORMAT}: format {metadata.get('format')!r:.40}")
    version = metadata.get("version")
    _need(version == VERSION, f"table version {version!r:.40}; this reader knows versions 5 and 6")
    for name, low, high in (
        ("height_m", 0.01, 1000.0),
        ("dt_s", 1e-4, 1.0),
        ("sigma_pa", 1e-9, 1e9),
        ("pose_easing", 0.0, 1.0),
        ("design_speed_m_s", 0.0, 100.0),
    ):
        _number(metadata, name, low, high)
    for name, high in (("modes", 256), ("records", 65535), ("points", 65535), ("components", 65535)):
        _need(_number(metadata, name, 1, high) % 1 == 0, f"metadata {name}: expected a whole number")
    weight = metadata.get("weight")
    _need(isinstance(weight, dict), "metadata weight: expected an object")
    initial = _number(metadata["weight"], "initial", 0.0, 0.999)
    _number(metadata["weight"], "maximum", initial, 0.999)
    _number(metadata["weight"], "growth", 0.0, 1.0)
    _need(isinstance(metadata.get("primitives"), list), "metadata primitives: expected a list")
    for primitive in metadata["primitives"]:
        _need(isinstance(primitive, dict), "metadata primitives: expected objects")
        _number(primitive, "vertices", 0, 2**31)


def _number(metadata: Metadata, name: str, low: float, high: float) -> float:
    value = metadata.get(name)
    real = isinstance(value, int | float) and not isinstance(value, bool) and low <= value <= high
    _need(real, f"metadata {name}: expected a number in {low:g}..{high:g}, not {value!r:.40}")
    return float(metadata[name])


def _check_shapes(table: Table) -> None:
    r, z, n = int(table.metadata["modes"]), int(table.metadata["records"]), len(table.node_rest_m)
    vertices = sum(int(p["vertices"]) for p in table.metadata["primitives"])
    d = len(table.modal_step)
    most = min(MAX_DYNAMIC, r)
    _need(2 <= d <= most, f"tensor modal.step: expected 2..{most} rows")
    c, odd = divmod(len(table.modal_limits) - 3, 2)
    _need(not odd and 0 <= c <= d - 2, f"tensor modal.limits: expected 3, 5, … {2 * d - 1} numbers")
    for name, shape in (
        ("modes.scale", (r,)),
        ("nodes.basis", (n, 3, r)),
        ("nodes.rest_m", (n, 3)),
        ("render.vertex_node", (vertices,)),
        ("samples.dq", (z, r)),
        ("samples.pressure_pa", (z, 2)),
        ("search.offsets", (z + 1,)),
        ("search.mismatch_steps", (len(table.candidate),)),
        ("modal.step", (d, 6)),
        ("modal.load", (d, 2)),
        ("modal.sway", (2, d)),
        ("modal.force", (force_terms(c), d)),
        ("modal.shown", (d,)),
        ("modal.pose", (d + 2 + shape_terms(c), r - d)),
        ("modal.limits", (3 + 2 * c,)),
    ):
        found = getattr(table, TENSORS[name][0]).shape
        _need(found == shape, f"tensor {name}: shape {found}, expected {shape}")


def _check_numbers(table: Table) -> None:
    for name, (field, dtype, _) in TENSORS.items():
        if dtype == np.float32:
            _need(bool(np.isfinite(getattr(table, field)).all()), f"tensor {name}: not finite")
    _need(bool((table.mode_scale > 0).all()), "tensor modes.scale: not positive")
    inside = not len(table.vertex_node) or int(table.vertex_node.max()) < len(table.node_rest_m)
    _need(inside, "tensor render.vertex_node: node out of range")


def _check_trajectories(table: Table) -> None:
    starts = table.trajectory.astype(np.int64)
    ends = len(starts) >= 2 and starts[0] == 0 and starts[-1] == len(table.dq)
    _need(bool(ends), "tensor samples.trajectory: must run from 0 to the number of records")
    # A trajectory of one record is never found: its only record has no successor.
    _need(bool((np.diff(starts) >= 2).all()), "tensor samples.trajectory: every trajectory needs two records")
    worst = math.prod([int(np.diff(starts).max()), 32768])
    _need(worst < 2**31, "tensor samples.trajectory: a trajectory is too long")


def _check_offsets(table: Table) -> None:
    offsets, nnz = table.offsets.astype(np.int64), len(table.candidate)
    _need(bool(offsets[0] == 0 and offsets[-1] == nnz), "tensor search.offsets: must run from 0 to the end")
    _need(bool((np.diff(offsets) >= 1).all()), "tensor search.offsets: every record needs a candidate")


def _check_search(table: Table) -> None:
    _check_offsets(table)
    offsets, z, nnz = table.offsets.astype(np.int64), len(table.dq), len(table.candidate)
    record = table.candidate.astype(np.int64)
    last = np.zeros(65536, np.bool_)
    last[z:] = True
    last[table.trajectory[1:].astype(np.int64) - 1] = True
    _need(not last[record].any(), "tensor search.record: out of range, or the last of its trajectory")
    mismatches = table.mismatches.astype(np.int64)
    _need(
        int(mismatches.max()) <= int(table.metadata["components"]),
        "tensor search.mismatch_steps: out of range",
    )
    key = mismatches * 65536 + record
    first = np.zeros(nnz, np.bool_)
    first[offsets[:-1]] = True
    _need(bool(((np.diff(key) > 0) | first[1:]).all()), "tensor search.record: candidates out of order")


def _check_modal(table: Table) -> None:
    """Check that every oscillator step contracts, so that a bounded wind gives a bounded motion."""
    _need(bool((table.modal_limits > 0).all()), "tensor modal.limits: not positive")
    step = table.modal_step.astype(np.float64)
    r00, r01, r10, r11 = 1.0 + step[:, 0], step[:, 1], step[:, 2], 1.0 + step[:, 3]
    product = r00 * r11 - r01 * r10
    contracts = (np.abs(product) < 1.0) & (np.abs(r00 + r11) < 1.0 + product)
    _need(bool(contracts.all()), "tensor modal.step: an oscillator that does not come to rest")
