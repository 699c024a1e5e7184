"""Quadratic (ten-node) tetrahedra: the reference element.

Linear tets lock in bending: in a branch two elements thick, they are several times too stiff. Straight-sided
quadratic tets do not, and need no new integrals: each of their 55 blocks is a constant combination of the ten
blocks of the linear tet, since ∇N_a = Σ_i w_ai(λ) ∇λ_i with w linear in the barycentric coordinates λ.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from galewood.solid.fem.elements.elasticity import PAIRS

EDGES: tuple[tuple[int, int], ...] = ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))


class Combination(NamedTuple):
    """Quadratic block `pair` = Σ coefficient · (linear block or its transpose), terms start..start+1."""

    rows: NDArray[np.int32]
    columns: NDArray[np.int32]
    start: NDArray[np.int32]
    coefficient: NDArray[np.float64]
    block: NDArray[np.int32]
    transposed: NDArray[np.int32]


def elevate(
    vertices_m: NDArray[np.float64], tets: NDArray[np.int32]
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Nodes (n + edges, 3) and elements (m, 10) of the quadratic mesh.

    The vertices come first, then the edge midpoints.
    """
    ends = np.sort(np.stack([tets[:, list(edge)] for edge in EDGES], axis=1), axis=2)
    unique, index = np.unique(ends.reshape(-1, 2), axis=0, return_inverse=True)
    middles = vertices_m[unique].mean(axis=1)
    nodes = np.concatenate([vertices_m, middles])
    elements = np.concatenate([tets, len(vertices_m) + index.reshape(len(tets), 6)], axis=1)
    return nodes, elements.astype(np.int32)


def midside_parents(vertex_count: int, elements: NDArray[np.int32]) -> NDArray[np.int32]:
    """(edges, 2): the two vertices of each midside node, in node order."""
    parents = np.zeros((int(elements.max()) + 1 - vertex_count, 2), np.int32)
    for local, edge in enumerate(EDGES):
        parents[elements[:, 4 + local] - vertex_count] = np.sort(elements[:, list(edge)], axis=1)
    return parents


def node_mass_shares() -> NDArray[np.float64]:
    """(10,) shares of an element's mass at its nodes: scaled consistent diagonal (HRZ lumping)."""
    # Mean of N_a² over the tet: 1/70 at a corner, 8/105 at a midside node.
    corner, midside = 1 / 70, 8 / 105
    shares = np.array([corner] * 4 + [midside] * 6)
    return shares / shares.sum()


def _weights(node: int) -> dict[int, NDArray[np.float64]]:
    """∇N of a node as {i: (constant, λ0..λ3 coefficients) of ∇λ_i}."""
    if node < 4:
        weight = np.zeros(5)
        weight[0], weight[1 + node] = -1, 4
        return {node: weight}
    i, j = EDGES[node - 4]
    first, second = np.zeros(5), np.zeros(5)
    first[1 + j], second[1 + i] = 4, 4
    return {i: first, j: second}


def _mean_product(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    """Mean over a tetrahedron of the product of two linear functions of λ."""
    moments = np.full((5, 5), 1 / 20)
    moments[0, 0], moments[0, 1:], moments[1:, 0] = 1, 1 / 4, 1 / 4
    moments[range(1, 5), range(1, 5)] = 1 / 10
    return float(a @ moments @ b)


def combination() -> Combination:
    """The 55 upper blocks (a ≤ b) of the quadratic tet in terms of the ten of the linear tet."""
    rows: list[int] = []
    columns: list[int] = []
    start = [0]
    terms: list[tuple[float, int, int]] = []
    for a in range(10):
        for b in range(a, 10):
            rows.append(a)
            columns.append(b)
            terms += _terms(a, b)
            start.append(len(terms))
    coefficient, block, transposed = zip(*terms, strict=True)
    return Combination(
        np.array(rows, np.int32),
        np.array(columns, np.int32),
        np.array(start, np.int32),
        np.array(coefficient),
        np.array(block, np.int32),
        np.array(transposed, np.int32),
    )


def _terms(a: int, b: int) -> list[tuple[float, int, int]]:
    found: list[tuple[float, int, int]] = []
    for i, weight_i in _weights(a).items():
        for j, weight_j in _weights(b).items():
            coefficient = _mean_product(weight_i, weight_j)
            if coefficient:
                found.append((coefficient, PAIRS.index((min(i, j), max(i, j))), int(i > j)))
    return found
