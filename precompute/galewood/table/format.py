"""The table format: one safetensors file per species (spec/formats/table.md).

``decode`` checks everything that readers rely on, so that a decoded table can be searched without bounds
checks.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from galewood.constants import (
    MAX_DRAG_POINTS,
    MAX_MODES,
    MAX_OSCILLATORS,
    MAX_PLACES,
    TABLE_FORMAT,
    TABLE_RANGES,
    TABLE_TENSORS,
    TABLE_VERSION,
)
from galewood.table.container import (
    Foliage,
    Layout,
    Metadata,
    TableError,
    check_finite,
    check_format,
    check_shapes,
    fields,
    foliage_of,
    layout,
    need,
    number,
    read_metadata,
    read_tensors,
    tensors_of,
    whole,
    write,
)
from galewood.table.records import (
    RECORDS_LAYOUT,
    Records,
    check_records,
    decode_records,
    read_records,
    record_tensors,
)

if TYPE_CHECKING:
    from galewood.motion.modal import ModalTensors


@dataclass(frozen=True)
class Table:
    """A decoded table: r modes, n nodes, j joints, v render vertices. Units in spec/formats/table.md."""

    metadata: Metadata
    mode_scale: npt.NDArray[np.float32]  # (r,)
    node_basis: npt.NDArray[np.float32]  # (n, 3, r) m per unit of q
    node_rest_m: npt.NDArray[np.float32]  # (n, 3)
    node_turn: npt.NDArray[np.float32]  # (n, 3, r) rotation vector per unit of q
    node_parent: npt.NDArray[np.uint16]  # (n,) node before it on its branch; its own index: none
    joint_nodes: npt.NDArray[np.uint16]  # (j, 2)
    joint_share: npt.NDArray[np.float32]  # (j,) share of the second node
    joint_rest_m: npt.NDArray[np.float32]  # (j, 3)
    vertex_joint: npt.NDArray[np.uint16]  # (v,)
    modal_step: npt.NDArray[np.float32]  # (d, 6); modal_*: see galewood.motion.modal.ModalTensors
    modal_load: npt.NDArray[np.float32]  # (d, 2)
    modal_sway: npt.NDArray[np.float32]  # (2, d)
    modal_force: npt.NDArray[np.float32]  # (44 + 6c, d)
    modal_shown: npt.NDArray[np.float32]  # (d,)
    modal_pose: npt.NDArray[np.float32]  # (d + 9 + 2c, r - d)
    modal_limits: npt.NDArray[np.float32]  # (3 + 2c,)
    modal_drag_point: npt.NDArray[np.float32]  # (m, 2)
    modal_drag_shape: npt.NDArray[np.float32]  # (3, m, d)
    modal_drag_rest: npt.NDArray[np.float32]  # (d,)
    modal_drag_place: npt.NDArray[np.float32]  # (m, G)
    modal_place: npt.NDArray[np.float32]  # (G, 3)
    modal_place_load: npt.NDArray[np.float32]  # (d, 2, G)
    paper: Records | None = None
    """Records of the paper's state search, if the table has them."""

    @property
    def modal(self) -> ModalTensors:
        """Tensors of the modal model."""
        from galewood.motion.modal import ModalTensors  # loads numba, which readers of metadata do not need

        return ModalTensors(
            self.modal_step, self.modal_load, self.modal_sway,
            self.modal_force, self.modal_shown, self.modal_pose, self.modal_limits,
            self.modal_drag_point, self.modal_drag_shape, self.modal_drag_rest, self.modal_drag_place,
            self.modal_place, self.modal_place_load, self.streamlined_exponent,
        )  # fmt: skip

    @property
    def vertex_node(self) -> npt.NDArray[np.uint16]:
        """(v,) the node nearest to each render vertex: that with the larger share in its joint."""
        nodes, share = self.joint_nodes, self.joint_share
        nearer: npt.NDArray[np.uint16] = np.where(share > 0.5, nodes[:, 1], nodes[:, 0])
        return nearer[self.vertex_joint]

    @property
    def modes(self) -> int:
        """r."""
        return int(self.metadata["modes"])

    @property
    def records(self) -> Records:
        """Records of the paper's state search. Raises TableError if the table has none."""
        if self.paper is None:
            raise TableError("this table has no records of the paper's state search")
        return self.paper

    @property
    def recorded_q_m(self) -> npt.NDArray[np.float64]:
        """(z, r) poses of the records, m. Raises TableError if the table has none."""
        return self.records.pose() * self.mode_scale.astype(np.float64)

    @property
    def peak_pressure_pa(self) -> float:
        """Largest dynamic pressure of the winds that the table was made from, Pa."""
        return float(self.metadata["peak_pressure_pa"])

    @property
    def streamlined_exponent(self) -> float:
        """Power of the wind speed with which the pressure on the tree grows above 5 m/s."""
        return float(self.metadata["streamlined_exponent"])

    @property
    def foliage(self) -> Foliage:
        """Whether the table was made from the tree in leaf or bare."""
        return foliage_of(self.metadata)


TABLE_LAYOUT: Layout = layout(
    TABLE_TENSORS,
    {
        "modes.scale": "mode_scale",
        "nodes.basis": "node_basis",
        "nodes.rest_m": "node_rest_m",
        "nodes.turn": "node_turn",
        "nodes.parent": "node_parent",
        "joints.nodes": "joint_nodes",
        "joints.share": "joint_share",
        "joints.rest_m": "joint_rest_m",
        "render.vertex_joint": "vertex_joint",
        "modal.step": "modal_step",
        "modal.load": "modal_load",
        "modal.sway": "modal_sway",
        "modal.force": "modal_force",
        "modal.shown": "modal_shown",
        "modal.pose": "modal_pose",
        "modal.limits": "modal_limits",
        "modal.drag_point": "modal_drag_point",
        "modal.drag_shape": "modal_drag_shape",
        "modal.drag_rest": "modal_drag_rest",
        "modal.drag_place": "modal_drag_place",
        "modal.place": "modal_place",
        "modal.place_load": "modal_place_load",
    },
)


def encode(table: Table) -> bytes:
    """Encode a table, with its records if it has any. Raises TableError if ``decode`` would refuse it."""
    check(table)
    tensors, metadata = tensors_of(table, TABLE_LAYOUT), dict(table.metadata)
    if table.paper is not None:
        tensors |= record_tensors(table.paper)
        metadata["paper"] = table.paper.metadata
    return write(tensors, metadata)


def decode(data: bytes, records: bytes | None = None) -> Table:
    """Decode the bytes of a table file, and of the records file that belongs to it. Raises TableError."""
    metadata = read_metadata(data)
    check_format(metadata, TABLE_FORMAT, TABLE_VERSION)
    tensors = read_tensors(data)
    extra = set(tensors) - set(TABLE_LAYOUT) - set(RECORDS_LAYOUT)
    if extra:
        raise TableError(f"unknown tensor {sorted(extra)[0]:.60}")
    paper = metadata.pop("paper", None)
    need(paper is not None or not set(tensors) & set(RECORDS_LAYOUT), "metadata paper: missing")
    table = Table(metadata, **fields(tensors, TABLE_LAYOUT))
    check(table)
    if paper is not None:
        return replace(table, paper=read_records(paper, tensors, table.modes))
    return with_records(table, records, hashlib.sha256(data).hexdigest()) if records else table


def with_records(table: Table, records: bytes, table_sha256: str) -> Table:
    """The table with the records of a file that was made for it. Raises TableError."""
    paper, belongs_to = decode_records(records)
    need(belongs_to == table_sha256, "these records belong to another table")
    check_records(paper, table.modes)
    return replace(table, paper=paper)


def check(table: Table) -> None:
    """Raise TableError unless the table conforms to the format."""
    check_metadata(table.metadata)
    _check_shapes(table)
    _check_numbers(table)
    _check_modal(table)
    if table.paper is not None:
        check_records(table.paper, table.modes)


def check_metadata(metadata: Metadata) -> None:
    """Check format, version and all numbers that readers use. Raises TableError."""
    check_format(metadata, TABLE_FORMAT, TABLE_VERSION)
    for name, (low, high) in TABLE_RANGES.items():
        number(metadata, name, low, high)
    whole(metadata, "modes", MAX_MODES)
    foliage_of(metadata)
    need(isinstance(metadata.get("primitives"), list), "metadata primitives: expected a list")
    for primitive in metadata["primitives"]:
        need(isinstance(primitive, dict), "metadata primitives: expected objects")
        number(primitive, "vertices", 0, 2**31)


def _check_shapes(table: Table) -> None:
    from galewood.motion.modal import force_terms, shape_terms

    r, n, joints = table.modes, len(table.node_rest_m), len(table.joint_share)
    vertices = sum(int(p["vertices"]) for p in table.metadata["primitives"])
    d, places = len(table.modal_step), len(table.modal_place)
    need(places <= MAX_PLACES, f"tensor modal.place: expected at most {MAX_PLACES} rows")
    most = min(MAX_OSCILLATORS, r)
    need(2 <= d <= most, f"tensor modal.step: expected 2..{most} rows")
    c, odd = divmod(len(table.modal_limits) - 3, 2)
    need(not odd and 0 <= c <= d - 2, f"tensor modal.limits: expected 3, 5, … {2 * d - 1} numbers")
    m = len(table.modal_drag_point)
    need(m <= MAX_DRAG_POINTS, f"tensor modal.drag_point: expected at most {MAX_DRAG_POINTS} rows")
    expected = {
        "modes.scale": (r,),
        "nodes.basis": (n, 3, r),
        "nodes.rest_m": (n, 3),
        "nodes.turn": (n, 3, r),
        "nodes.parent": (n,),
        "joints.nodes": (joints, 2),
        "joints.share": (joints,),
        "joints.rest_m": (joints, 3),
        "render.vertex_joint": (vertices,),
        "modal.step": (d, 6),
        "modal.load": (d, 2),
        "modal.sway": (2, d),
        "modal.force": (force_terms(c), d),
        "modal.shown": (d,),
        "modal.pose": (d + 2 + shape_terms(c), r - d),
        "modal.limits": (3 + 2 * c,),
        "modal.drag_point": (m, 2),
        "modal.drag_shape": (3, m, d),
        "modal.drag_rest": (d,),
        "modal.drag_place": (m, places),
        "modal.place": (places, 3),
        "modal.place_load": (d, 2, places),
    }
    check_shapes(table, TABLE_LAYOUT, expected)


def _check_numbers(table: Table) -> None:
    check_finite(table, TABLE_LAYOUT)
    need(bool((table.mode_scale > 0).all()), "tensor modes.scale: not positive")
    nodes = np.arange(len(table.node_rest_m))
    need(bool((table.node_parent <= nodes).all()), "tensor nodes.parent: a node that does not come later")
    inside = int(table.joint_nodes.max(initial=0)) < max(len(nodes), 1)
    need(inside and (len(nodes) > 0 or not len(table.joint_nodes)), "tensor joints.nodes: node out of range")
    share = table.joint_share
    need(bool(((share >= 0) & (share <= 1)).all()), "tensor joints.share: expected shares in 0..1")
    inside = not len(table.vertex_joint) or int(table.vertex_joint.max()) < len(share)
    need(inside, "tensor render.vertex_joint: joint out of range")


def _check_modal(table: Table) -> None:
    """Check that every oscillator step contracts, so that a bounded wind gives a bounded motion."""
    need(bool((table.modal_limits > 0).all()), "tensor modal.limits: not positive")
    need(bool((table.modal_drag_rest >= 0).all()), "tensor modal.drag_rest: negative")
    area, share = table.modal_drag_point[:, 0], table.modal_drag_point[:, 1]
    inside = (
        (area >= 0).all() and (share >= 0).all() and (share <= 1).all() and bool(area.any() or not len(area))
    )
    need(bool(inside), "tensor modal.drag_point: expected areas of at least 0, not all 0, and shares in 0..1")
    need(_contracts(table.modal_step), "tensor modal.step: an oscillator that does not come to rest")


def _contracts(step: npt.NDArray[np.float32]) -> bool:
    """Whether all steps (k, 6) contract."""
    wide = step.astype(np.float64)
    r00, r01, r10, r11 = 1.0 + wide[:, 0], wide[:, 1], wide[:, 2], 1.0 + wide[:, 3]
    product = r00 * r11 - r01 * r10
    return bool(((np.abs(product) < 1.0) & (np.abs(r00 + r11) < 1.0 + product)).all())
