"""The compliance file of a tree: the factor of its stiffness, and its render mesh bound to the solid."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import scipy.sparse

from galewood.constants import BINDING_CORNERS, WHOLE_WEIGHT
from galewood.solid.fem import FemModel, NotPositiveDefinite, TangentFactor, tangent_factor
from galewood.table import Compliance, TableError, encode_compliance
from galewood.util import Array, Floats, Ints


def compliance_file(model: FemModel, embedding: scipy.sparse.csr_matrix, mesh_sha256: str) -> bytes | None:
    """The compliance file of a model whose vertices move the render mesh by ``embedding`` (v, vertices).

    None if the rest pose is unstable or the solid has too many nodes: then only the modes respond.
    """
    try:
        return encode_compliance(compliance_of(tangent_factor(model), embedding, mesh_sha256))
    except (NotPositiveDefinite, TableError):
        return None


def compliance_of(factor: TangentFactor, embedding: scipy.sparse.csr_matrix, mesh_sha256: str) -> Compliance:
    """The factor in 32 bits and the embedding as rows of four nodes, equal ones stored once."""
    corner, share = four_largest(embedding)
    node = factor.rank[corner]
    weight = whole_weights(share)
    rows, vertex_row = np.unique(np.concatenate([node, weight], axis=1), axis=0, return_inverse=True)
    return Compliance(
        mesh_sha256=mesh_sha256,
        pointer=factor.pointer.astype(np.uint32),
        rows=factor.rows.astype(np.uint16),
        blocks=factor.blocks.astype(np.float32),
        mass_kg=factor.mass_kg.astype(np.float32),
        limit_n=factor.limit_n.astype(np.float32),
        node=rows[:, :BINDING_CORNERS].astype(np.uint16),
        weight=rows[:, BINDING_CORNERS:].astype(np.uint16),
        vertex_row=np.ravel(vertex_row).astype(np.uint32),
    )


def four_largest(embedding: scipy.sparse.csr_matrix) -> tuple[Ints, Floats]:
    """Columns (v, 4) and weights (v, 4) of the largest entries of each row, normalised to sum 1."""
    start: Ints = np.asarray(embedding.indptr)
    column: Ints = np.asarray(embedding.indices)
    value: Floats = np.asarray(embedding.data, np.float64)
    count = len(start) - 1
    row = np.repeat(np.arange(count), np.diff(start))
    order = np.lexsort((-value, row))
    place = np.arange(len(order)) - start[row]
    kept = place < BINDING_CORNERS
    corner = np.zeros((count, BINDING_CORNERS), np.int64)
    share = np.zeros((count, BINDING_CORNERS))
    corner[row[kept], place[kept]] = column[order[kept]]
    share[row[kept], place[kept]] = value[order[kept]]
    return corner, share / share.sum(axis=1, keepdims=True)


def whole_weights(share: Floats) -> npt.NDArray[np.int64]:
    """Weights (v, 4) in units of 1/65535 that sum to 65535; the first, the largest, takes the rest."""
    weight: Array = np.rint(share * WHOLE_WEIGHT).astype(np.int64)
    weight[:, 0] += WHOLE_WEIGHT - weight.sum(axis=1)
    return weight
