"""What the compliance file says of the finite elements: masses, places and response of the solid's nodes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse
import scipy.sparse.linalg

from galewood.constants import BINDING_CORNERS, WHOLE_WEIGHT
from galewood.solid.fem import solve_factor
from galewood.table import Compliance
from galewood.util import Floats, Ints

COUPLED_SHARE = 1e-6
"""Nodes count as neighbours if they couple by more than this share of the strongest coupling."""


@dataclass(frozen=True)
class Solid:
    """The n free nodes of a tree's finite elements, known by the vertices that are bound to them."""

    compliance: Compliance

    @property
    def mass_kg(self) -> Floats:
        """(n,) lumped masses, foliage included."""
        return self.compliance.mass_kg.astype(np.float64)

    @cached_property
    def binding(self) -> Any:
        """(v, n) sparse: a vertex moves by these shares of the nodes."""
        file = self.compliance
        corner = file.node[file.vertex_row].astype(np.int64)
        share = file.weight[file.vertex_row].astype(np.float64) / WHOLE_WEIGHT
        row = np.repeat(np.arange(len(corner)), BINDING_CORNERS)
        shape = (len(corner), file.free + 1)
        return scipy.sparse.csr_matrix((share.ravel(), (row, corner.ravel())), shape)[:, :-1]

    def solve(self, load_n: Floats) -> Floats:
        """(n, 3) m: displacement of the nodes under forces (n, 3), N."""
        u = np.ascontiguousarray(load_n, np.float64).copy()
        solve_factor(self.compliance.pointer, self.compliance.rows, self.compliance.blocks, u)
        return u

    def response(self, shares: Floats) -> Floats:
        """(p, 3, 3) m/N: how groups of nodes yield to forces on them; ``shares`` (p, n), rows sum to 1."""
        found = np.zeros((len(shares), 3, 3))
        for group, share in enumerate(shares):
            for axis in range(3):
                load = np.zeros((len(share), 3))
                load[:, axis] = share
                found[group, :, axis] = share @ self.solve(load)
        return 0.5 * (found + found.transpose(0, 2, 1))

    def modes(self, count: int) -> tuple[Floats, Floats]:
        """Angular frequencies (k,), rad/s, and mass-normalised shapes (n, 3, k) of the lowest modes."""
        root = np.sqrt(self.mass_kg)[:, None]
        size = 3 * len(root)

        def yields(x: Floats) -> Floats:
            return (root * self.solve(root * x.reshape(-1, 3))).ravel()

        operator = scipy.sparse.linalg.LinearOperator((size, size), matvec=yields, dtype=np.float64)  # pyright: ignore[reportCallIssue]
        start = np.ones(size)  # the same file at every call
        value, vector = scipy.sparse.linalg.eigsh(operator, k=count, which="LM", v0=start)
        shape = vector.T.reshape(count, -1, 3).transpose(1, 2, 0) / root[:, :, None]
        return 1.0 / np.sqrt(value[::-1]), shape[:, :, ::-1]

    def spread(self, vertices: Ints, values: Floats) -> Floats:
        """(n, k) values at the nodes from those (w, k) at some vertices, which should be of the wood.

        Nodes without vertices take the mean of their neighbours, weighted by how strongly they couple.
        """
        binding = self.binding[vertices]
        total = np.asarray(binding.sum(axis=0)).ravel()
        known = total > 0
        found = np.asarray(binding.T @ values)
        found[known] /= total[known, None]
        if known.all():
            return found
        coupling = self._coupling()
        degree = np.asarray(coupling.sum(axis=1)).ravel()
        laplacian = (scipy.sparse.diags(degree) - coupling).tocsr()
        hidden = np.flatnonzero(~known)
        inner = laplacian[hidden][:, hidden].tocsc()
        load = -laplacian[hidden][:, np.flatnonzero(known)] @ found[known]
        found[hidden] = scipy.sparse.linalg.splu(inner).solve(np.ascontiguousarray(load))
        return found

    def _coupling(self) -> Any:
        """(n, n) sparse: how strongly nodes couple, ≥ 0, from K = L Lᵀ."""
        file = self.compliance
        pointer, n = file.pointer.astype(np.int64), file.free
        blocks = file.blocks.reshape(-1, 3, 3).astype(np.float64)
        blocks[pointer[:-1]] = np.linalg.inv(_lower(file.blocks[pointer[:-1]].astype(np.float64)))
        column = np.repeat(np.arange(n), np.diff(pointer))
        factor = scipy.sparse.bsr_matrix(
            scipy.sparse.coo_matrix(
                (
                    blocks.ravel(),
                    (
                        (
                            3 * file.rows.astype(np.int64)[:, None, None]
                            + np.arange(3)[:, None]
                            + np.zeros(3, np.int64)
                        ).ravel(),
                        (3 * column[:, None, None] + np.zeros((3, 1), np.int64) + np.arange(3)).ravel(),
                    ),
                ),
                shape=(3 * n, 3 * n),
            ).tocsr(),
            blocksize=(3, 3),
        )
        stiffness = scipy.sparse.coo_matrix(factor.tocsr() @ factor.tocsr().T)
        node = stiffness.row // 3, stiffness.col // 3
        strength = scipy.sparse.csr_matrix((np.abs(stiffness.data), node), shape=(n, n))
        strength.setdiag(0.0)
        strength.data[strength.data < COUPLED_SHARE * strength.data.max()] = 0.0
        strength.eliminate_zeros()
        return strength


def _lower(packed: Floats) -> Floats:
    """(n, 3, 3) lower triangles from i00, i10, i11, i20, i21, i22."""
    found = np.zeros((len(packed), 3, 3))
    row, column = np.tril_indices(3)
    found[:, row, column] = packed[:, :6]
    return found
