"""Corotational assembly of internal forces and stiffness blocks.

Each element's deformation gradient F is decomposed into a rotation R and a stretch (polar decomposition). The
element force is R K (Rᵀ x − X) and its tangent R K Rᵀ, where K is the small-strain stiffness of
`elasticity.py`. A quadratic element takes R from its four corners.

Linear elements are processed in batches of eight (`linear_batches.py`), quadratic ones one by one (here).

All arrays are in the elimination order of the solver, so that the assembled blocks map directly to the
pattern of the factor. Blocks that involve a fixed node are written to one unused block at the end.
"""

from copy import copy

import numba
import numpy as np
from numpy.typing import NDArray

from galewood.solid.fem.elements.linear_batches import LinearBatches, linear_batches
from galewood.solid.fem.elements.quadratic import combination
from galewood.solid.fem.elements.rotation import Nine, nearest_rotation
from galewood.solid.fem.solver import JIT, BlockCholesky
from galewood.util import Floats, Int32s

_COMBINATION = combination()


class ElementSystem:
    """The elements of a mesh, renumbered for its solver.

    rest_m (N,3), elements (m, 4|10), grad (m,4,3), blocks (m,10,3,3), fixed (k,): clamped nodes. prestress
    (m,10) N/m: contribution of the rest-pose stress to the diagonals of the tangent's blocks. strain_m
    (m, 4|10, 3): strain of the given shape, as displacements of each element's nodes. foundation_n_m
    (N,) N/m: springs between the nodes and the ground, equal in all directions; None: none. `order` maps
    internal to mesh node numbers: free nodes in elimination order, then the fixed ones.
    """

    def __init__(
        self,
        rest_m: Floats,
        elements: Int32s,
        grad: Floats,
        blocks: Floats,
        fixed: Int32s,
        prestress: Floats | None = None,
        strain_m: Floats | None = None,
        foundation_n_m: Floats | None = None,
    ) -> None:
        free = np.setdiff1d(np.arange(len(rest_m)), fixed)
        compact = np.full(len(rest_m), -1, np.int64)
        compact[free] = np.arange(len(free))
        self.solver = BlockCholesky(len(free), _node_pairs(compact[elements]))
        self.order = np.concatenate([free[self.solver.order], np.sort(fixed)]).astype(np.int32)
        self.rank = np.empty(len(rest_m), np.int32)
        self.rank[self.order] = np.arange(len(rest_m), dtype=np.int32)
        self.free = len(free)
        self.rest = np.ascontiguousarray(rest_m[self.order])
        self.elements = np.ascontiguousarray(self.rank[elements])
        self.quadratic = elements.shape[1] == 10
        self.grad = np.ascontiguousarray(grad)
        self.blocks = np.ascontiguousarray(blocks.reshape(len(blocks), 10, 9))
        self.prestress = np.zeros((len(blocks), 10)) if prestress is None else np.ascontiguousarray(prestress)
        self.strain = np.zeros((*elements.shape, 3)) if strain_m is None else np.ascontiguousarray(strain_m)
        self.foundation = None if foundation_n_m is None else np.ascontiguousarray(foundation_n_m[self.order])
        self.slots, self.flips = self._scatter_map()
        self._linear = None if self.quadratic else self._batches()
        self.values = np.zeros((self.solver.blocks + 1, 9))
        self.diagonal = self.solver.pointer[:-1]

    def around(self, nodes: Int32s) -> "ElementSystem":
        """The elements that touch the given internal nodes, to compute forces on those nodes only.

        The result shares all other data with this system.
        """
        wanted = np.zeros(len(self.rest), np.bool_)
        wanted[nodes] = True
        touching = wanted[self.elements].any(axis=1)
        part = copy(self)
        for name in ("elements", "grad", "blocks", "prestress", "strain", "slots", "flips"):
            setattr(part, name, np.ascontiguousarray(getattr(self, name)[touching]))
        part._linear = None if self.quadratic else part._batches()
        return part

    def set_blocks(self, blocks: Floats) -> None:
        """Replace the element stiffness (m,10,3,3), N/m."""
        self.blocks = np.ascontiguousarray(blocks.reshape(len(blocks), 10, 9))
        if self._linear:
            self._linear = self._linear.with_blocks(self.blocks)

    def set_prestress(self, prestress: Floats) -> None:
        """Replace the rest-pose stress contribution (m,10), N/m."""
        self.prestress = np.ascontiguousarray(prestress)
        if self._linear:
            self._linear = self._linear.with_prestress(self.prestress)

    def set_strain(self, strain_m: Floats) -> None:
        """Replace the strain of the given shape (m, 4|10, 3), m."""
        self.strain = np.ascontiguousarray(strain_m)
        if self._linear:
            self._linear = self._batches()

    def _batches(self) -> LinearBatches:
        return linear_batches(
            self.rest, self.elements, self.grad, self.blocks, self.prestress, self.strain, self._lower_slots
        )

    def _scatter_map(self) -> tuple[Int32s, NDArray[np.bool_]]:
        """Destination of each element block in the factor's pattern, and whether it is transposed."""
        width = self.elements.shape[1]
        pairs = [(a, b) for a in range(width) for b in range(a, width)]
        first, second = (self.elements[:, [pair[k] for pair in pairs]] for k in (0, 1))
        return self._lower_slots(np.maximum(first, second), np.minimum(first, second)), first < second

    def _lower_slots(self, high: Int32s, low: Int32s) -> Int32s:
        """Slots of lower-triangle blocks (rows `high`, columns `low`); the unused slot for fixed nodes."""
        slots = np.full(low.shape, self.solver.blocks, np.int32)
        inside = high < self.free
        slots[inside] = self.solver.slots(high[inside], low[inside])
        return slots

    def force(self, u: Floats, w: Floats, out: Floats) -> None:
        """Internal force (N,3), N, at displacement u (m), plus the linear response to w with rotations fixed.

        Σ R K (Rᵀ (x + w) − X) + K_σ w, that is, the force linearised at u, including the rest-pose stress.
        """
        self._run(u, w, 0.0, False, out)

    def assemble(self, u: Floats, w: Floats, scale: float, mass: Floats, out: Floats) -> None:
        """`force` and `values` = scale · stiffness(u) + diag(mass), lower blocks in the factor's pattern."""
        _begin_values(self.values, self.diagonal, mass)
        self._run(u, w, scale, True, out)

    def add_to_diagonal(self, blocks: Floats, factor: float) -> None:
        """Add ``factor`` times blocks (N,9) of the nodes to the diagonal of the assembled `values`."""
        _add_blocks(self.values, self.diagonal, blocks, factor)

    def _run(self, u: Floats, w: Floats, scale: float, matrix: bool, out: Floats) -> None:
        out[:] = 0.0
        if self.foundation is not None:
            self._add_foundation(self.foundation, u, w, scale, matrix, out)
        if self._linear:
            self._linear.run(u, w, scale, matrix, self.values, out)
            return
        c = _COMBINATION
        shape = (self.rest, self.elements, self.grad, self.strain)
        mesh = (*shape, self.blocks, self.prestress, self.slots, self.flips)
        terms = (c.rows, c.columns, c.start, c.coefficient, c.block, c.transposed)
        _assemble10(*terms, *mesh, u, w, scale, matrix, self.values, out)

    def _add_foundation(
        self, springs: Floats, u: Floats, w: Floats, scale: float, matrix: bool, out: Floats
    ) -> None:
        held = np.flatnonzero(springs)
        out[held] += springs[held, None] * (u[held] + w[held])
        if matrix:
            inside = held[held < self.free]
            for k in (0, 4, 8):
                self.values[self.diagonal[inside], k] += scale * springs[inside]

    def diagonal_blocks(self, nodes: Int32s) -> Floats:
        """(q,3,3) diagonal blocks of the last assembled matrix at internal nodes (zero at fixed ones)."""
        found = np.zeros((len(nodes), 9))
        free = nodes < self.free
        found[free] = self.values[self.diagonal[nodes[free]]]
        return found.reshape(-1, 3, 3)


@numba.njit(cache=True, nogil=True)
def _begin_values(values: Floats, diagonal: Int32s, mass: Floats) -> None:
    values[:] = 0.0
    for node, slot in enumerate(diagonal):
        for k in (0, 4, 8):
            values[slot, k] = mass[node]


@numba.njit(cache=True, nogil=True)
def _add_blocks(values: Floats, diagonal: Int32s, blocks: Floats, factor: float) -> None:
    for node, slot in enumerate(diagonal):
        for k in range(9):
            values[slot, k] += factor * blocks[node, k]


def _node_pairs(elements: NDArray[np.int64]) -> Int32s:
    """Distinct pairs of free nodes that share an element (−1 marks a fixed node)."""
    width = elements.shape[1]
    pairs = np.concatenate([elements[:, [a, b]] for a in range(width) for b in range(a + 1, width)])
    pairs = np.sort(pairs[(pairs >= 0).all(axis=1)], axis=1)
    keys = np.unique(pairs[:, 0] * (elements.max() + 1) + pairs[:, 1])
    return np.stack([keys // (elements.max() + 1), keys % (elements.max() + 1)], axis=1).astype(np.int32)


@numba.njit(**JIT)
def _pose(
    rest: Floats, u: Floats, w: Floats, elements: Int32s, grad: Floats, strain: Floats, e: int, d: Floats
) -> Nine:
    """Rotation of element e; d (k,3) ← nodal displacements relative to that rotation, in world axes.

    All differences are relative to the element's first node and computed from displacements rather than
    positions, so that rounding errors scale with the deformation and not with the size of the tree.
    """
    n0 = elements[e, 0]
    h0 = h1 = h2 = h3 = h4 = h5 = h6 = h7 = h8 = 0.0
    for a in range(1, 4):
        n = elements[e, a]
        g0, g1, g2 = grad[e, a, 0], grad[e, a, 1], grad[e, a, 2]
        v0, v1, v2 = u[n, 0] - u[n0, 0], u[n, 1] - u[n0, 1], u[n, 2] - u[n0, 2]
        h0 += v0 * g0
        h1 += v0 * g1
        h2 += v0 * g2
        h3 += v1 * g0
        h4 += v1 * g1
        h5 += v1 * g2
        h6 += v2 * g0
        h7 += v2 * g1
        h8 += v2 * g2
    r = nearest_rotation((h0, h1, h2, h3, h4, h5, h6, h7, h8))
    for a in range(elements.shape[1]):
        n = elements[e, a]
        s0, s1, s2 = (
            strain[e, a, 0] - strain[e, 0, 0], strain[e, a, 1] - strain[e, 0, 1],
            strain[e, a, 2] - strain[e, 0, 2],
        )  # fmt: skip
        x0 = rest[n, 0] - rest[n0, 0] - s0
        x1 = rest[n, 1] - rest[n0, 1] - s1
        x2 = rest[n, 2] - rest[n0, 2] - s2
        d[a, 0] = u[n, 0] - u[n0, 0] + w[n, 0] - w[n0, 0] + s0 + ((1.0 - r[0]) * x0 - r[1] * x1 - r[2] * x2)
        d[a, 1] = u[n, 1] - u[n0, 1] + w[n, 1] - w[n0, 1] + s1 + ((1.0 - r[4]) * x1 - r[3] * x0 - r[5] * x2)
        d[a, 2] = u[n, 2] - u[n0, 2] + w[n, 2] - w[n0, 2] + s2 + ((1.0 - r[8]) * x2 - r[6] * x0 - r[7] * x1)
    return r


@numba.njit(**JIT)
def _rotated(r: Nine, blocks: Floats, e: int, p: int) -> Nine:
    """R K Rᵀ of one block."""
    k0, k1, k2 = blocks[e, p, 0], blocks[e, p, 1], blocks[e, p, 2]
    k3, k4, k5 = blocks[e, p, 3], blocks[e, p, 4], blocks[e, p, 5]
    k6, k7, k8 = blocks[e, p, 6], blocks[e, p, 7], blocks[e, p, 8]
    r0, r1, r2, r3, r4, r5, r6, r7, r8 = r
    a0 = r0 * k0 + r1 * k3 + r2 * k6
    a1 = r0 * k1 + r1 * k4 + r2 * k7
    a2 = r0 * k2 + r1 * k5 + r2 * k8
    b0 = r3 * k0 + r4 * k3 + r5 * k6
    b1 = r3 * k1 + r4 * k4 + r5 * k7
    b2 = r3 * k2 + r4 * k5 + r5 * k8
    c0 = r6 * k0 + r7 * k3 + r8 * k6
    c1 = r6 * k1 + r7 * k4 + r8 * k7
    c2 = r6 * k2 + r7 * k5 + r8 * k8
    return (
        a0 * r0 + a1 * r1 + a2 * r2,
        a0 * r3 + a1 * r4 + a2 * r5,
        a0 * r6 + a1 * r7 + a2 * r8,
        b0 * r0 + b1 * r1 + b2 * r2,
        b0 * r3 + b1 * r4 + b2 * r5,
        b0 * r6 + b1 * r7 + b2 * r8,
        c0 * r0 + c1 * r1 + c2 * r2,
        c0 * r3 + c1 * r4 + c2 * r5,
        c0 * r6 + c1 * r7 + c2 * r8,
    )


@numba.njit(**JIT)
def _apply(k: Nine, d: Floats, f: Floats, a: int, b: int) -> None:
    """f_a += k d_b and, off the diagonal, f_b += kᵀ d_a."""
    x, y, z = d[b, 0], d[b, 1], d[b, 2]
    f[a, 0] += k[0] * x + k[1] * y + k[2] * z
    f[a, 1] += k[3] * x + k[4] * y + k[5] * z
    f[a, 2] += k[6] * x + k[7] * y + k[8] * z
    if a != b:
        x, y, z = d[a, 0], d[a, 1], d[a, 2]
        f[b, 0] += k[0] * x + k[3] * y + k[6] * z
        f[b, 1] += k[1] * x + k[4] * y + k[7] * z
        f[b, 2] += k[2] * x + k[5] * y + k[8] * z


@numba.njit(**JIT)
def _add_block(v: Floats, slot: int, scale: float, k: Nine, flip: bool) -> None:
    """v[slot] += scale · k, transposed if `flip`."""
    k1, k2, k3, k5, k6, k7 = k[1], k[2], k[3], k[5], k[6], k[7]
    if flip:
        k1, k2, k3, k5, k6, k7 = k3, k6, k1, k7, k2, k5
    v[slot, 0] += scale * k[0]
    v[slot, 1] += scale * k1
    v[slot, 2] += scale * k2
    v[slot, 3] += scale * k3
    v[slot, 4] += scale * k[4]
    v[slot, 5] += scale * k5
    v[slot, 6] += scale * k6
    v[slot, 7] += scale * k7
    v[slot, 8] += scale * k[8]


@numba.njit(**JIT)
def _shifted(k: Nine, s: float) -> Nine:
    """K + s I."""
    return k[0] + s, k[1], k[2], k[3], k[4] + s, k[5], k[6], k[7], k[8] + s


@numba.njit(**JIT)
def _add_scaled(out: Floats, w: Floats, na: int, nb: int, s: float) -> None:
    """out[na] += s w[nb] and vice versa."""
    for i in range(3):
        out[na, i] += s * w[nb, i]
    if na != nb:
        for i in range(3):
            out[nb, i] += s * w[na, i]


@numba.njit(**JIT)
def _assemble10(
    rows: Int32s,
    columns: Int32s,
    start: Int32s,
    coefficient: Floats,
    block: Int32s,
    transposed: Int32s,
    rest: Floats,
    elements: Int32s,
    grad: Floats,
    strain: Floats,
    blocks: Floats,
    prestress: Floats,
    slots: Int32s,
    flips: NDArray[np.bool_],
    u: Floats,
    w: Floats,
    scale: float,
    matrix: bool,
    values: Floats,
    out: Floats,
) -> None:
    """Forces and, if `matrix`, the stiffness of quadratic tets.

    Each block is a constant combination of the ten rotated linear blocks.
    """
    d, f = np.empty((10, 3)), np.empty((10, 3))
    rotated = np.empty((20, 9))
    for e in range(len(elements)):
        r = _pose(rest, u, w, elements, grad, strain, e, d)
        f[:] = 0.0
        for p in range(10):
            k = _rotated(r, blocks, e, p)
            for i in range(3):
                for j in range(3):
                    rotated[p, 3 * i + j] = k[3 * i + j]
                    rotated[10 + p, 3 * j + i] = k[3 * i + j]
        for p in range(len(rows)):
            k0 = k1 = k2 = k3 = k4 = k5 = k6 = k7 = k8 = 0.0
            for t in range(start[p], start[p + 1]):
                s = block[t] + 10 * transposed[t]
                c = coefficient[t]
                k0 += c * rotated[s, 0]
                k1 += c * rotated[s, 1]
                k2 += c * rotated[s, 2]
                k3 += c * rotated[s, 3]
                k4 += c * rotated[s, 4]
                k5 += c * rotated[s, 5]
                k6 += c * rotated[s, 6]
                k7 += c * rotated[s, 7]
                k8 += c * rotated[s, 8]
            k = (k0, k1, k2, k3, k4, k5, k6, k7, k8)
            _apply(k, d, f, rows[p], columns[p])
            more = 0.0
            for t in range(start[p], start[p + 1]):
                more += coefficient[t] * prestress[e, block[t]]
            _add_scaled(out, w, elements[e, rows[p]], elements[e, columns[p]], more)
            if matrix:
                _add_block(values, slots[e, p], scale, _shifted(k, more), flips[e, p])
        for a in range(10):
            for i in range(3):
                out[elements[e, a], i] += f[a, i]
