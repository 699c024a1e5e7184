"""The compliance file: how a tree yields to small point forces (spec/formats/compliance.md).

``decode_compliance`` checks everything, so that a decoded file can be solved without bounds checks.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from galewood.constants import (
    BINDING_CORNERS,
    COMPLIANCE_FORMAT,
    COMPLIANCE_TENSORS,
    COMPLIANCE_VERSION,
    MAX_COMPLIANCE_NODES,
    WHOLE_WEIGHT,
)
from galewood.table.container import (
    Layout,
    Metadata,
    check_finite,
    check_format,
    check_shapes,
    fields,
    layout,
    need,
    read_metadata,
    read_tensors,
    tensors_of,
    whole,
    write,
)


@dataclass(frozen=True)
class Compliance:
    """Factor of a tree's tangent stiffness at rest, and the render mesh bound to it.

    n free nodes of the solid in elimination order, b blocks of the factor, w rows of weights, v render
    vertices. The factor is that of galewood.solid.fem.TangentFactor.
    """

    mesh_sha256: str
    pointer: npt.NDArray[np.uint32]  # (n + 1,)
    rows: npt.NDArray[np.uint16]  # (b,)
    blocks: npt.NDArray[np.float32]  # (b, 9)
    mass_kg: npt.NDArray[np.float32]  # (n,)
    limit_n: npt.NDArray[np.float32]  # (n,)
    node: npt.NDArray[np.uint16]  # (w, 4), n for a clamped node
    weight: npt.NDArray[np.uint16]  # (w, 4), each row sums to WHOLE_WEIGHT
    vertex_row: npt.NDArray[np.uint32]  # (v,)

    @property
    def free(self) -> int:
        """n: number of free nodes."""
        return len(self.mass_kg)


COMPLIANCE_LAYOUT: Layout = layout(
    COMPLIANCE_TENSORS,
    {
        "factor.pointer": "pointer",
        "factor.rows": "rows",
        "factor.blocks": "blocks",
        "nodes.mass_kg": "mass_kg",
        "nodes.limit_n": "limit_n",
        "bind.node": "node",
        "bind.weight": "weight",
        "bind.vertex_row": "vertex_row",
    },
)


def encode_compliance(compliance: Compliance) -> bytes:
    """Encode a compliance file. Raises TableError if ``decode_compliance`` would refuse it."""
    _check(compliance)
    metadata: Metadata = {
        "format": COMPLIANCE_FORMAT,
        "version": COMPLIANCE_VERSION,
        "mesh_sha256": compliance.mesh_sha256,
        "nodes": compliance.free,
        "vertices": len(compliance.vertex_row),
    }
    return write(tensors_of(compliance, COMPLIANCE_LAYOUT), metadata)


def decode_compliance(data: bytes) -> Compliance:
    """Decode a compliance file. Raises TableError."""
    metadata = read_metadata(data)
    check_format(metadata, COMPLIANCE_FORMAT, COMPLIANCE_VERSION)
    tensors = read_tensors(data)
    extra = set(tensors) - set(COMPLIANCE_LAYOUT)
    need(not extra, f"unknown tensor {sorted(extra)[:1]!r:.60}")
    compliance = Compliance(str(metadata.get("mesh_sha256")), **fields(tensors, COMPLIANCE_LAYOUT))
    need(
        whole(metadata, "nodes", MAX_COMPLIANCE_NODES) == compliance.free,
        "metadata nodes: not that of the tensors",
    )
    _check(compliance)
    return compliance


def _check(compliance: Compliance) -> None:
    n, b = compliance.free, len(compliance.rows)
    need(1 <= n <= MAX_COMPLIANCE_NODES, f"tensor nodes.mass_kg: expected 1 to {MAX_COMPLIANCE_NODES} nodes")
    shapes = {
        "factor.pointer": (n + 1,),
        "factor.blocks": (b, 9),
        "nodes.limit_n": (n,),
        "bind.weight": (len(compliance.node), BINDING_CORNERS),
        "bind.node": (len(compliance.node), BINDING_CORNERS),
    }
    check_shapes(compliance, COMPLIANCE_LAYOUT, shapes)
    check_finite(compliance, COMPLIANCE_LAYOUT)
    _check_factor(compliance, n, b)
    need(bool((compliance.mass_kg > 0).all()), "tensor nodes.mass_kg: must be positive")
    need(bool((compliance.limit_n > 0).all()), "tensor nodes.limit_n: must be positive")
    need(bool((compliance.node <= n).all()), "tensor bind.node: out of range")
    sums = compliance.weight.astype(np.int64).sum(axis=1)
    need(bool((sums == WHOLE_WEIGHT).all()), "tensor bind.weight: a row does not sum to 65535")
    need(bool((compliance.vertex_row < len(compliance.node)).all()), "tensor bind.vertex_row: out of range")


def _check_factor(compliance: Compliance, n: int, b: int) -> None:
    pointer, rows = compliance.pointer.astype(np.int64), compliance.rows.astype(np.int64)
    rising = pointer[0] == 0 and pointer[-1] == b and bool((np.diff(pointer) >= 1).all())
    need(rising, "tensor factor.pointer: must rise from 0 to the number of blocks")
    column = np.repeat(np.arange(n), np.diff(pointer))
    diagonal = np.zeros(b, np.bool_)
    diagonal[pointer[:-1]] = True
    below = np.where(diagonal, rows == column, (rows > column) & (rows < n))
    need(bool(below.all()), "tensor factor.rows: not a lower triangle, diagonal first")
    inverse = compliance.blocks[pointer[:-1]][:, [0, 2, 5]]
    need(bool((inverse > 0).all()), "tensor factor.blocks: the diagonal must be positive")
