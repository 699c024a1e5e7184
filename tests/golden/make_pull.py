"""Write the golden pulls for both languages: ``python -m tests.golden.make_pull``.

A compliance file for the mesh of the golden table, made of a chain of springs instead of a solid, the
response of some of its points, and a hand that pulls one of them.
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from galewood.player import DragConstraint, point_response
from galewood.solid.fem import TangentFactor
from galewood.table import Compliance, Table, decode, decode_compliance, encode_compliance

from tests.golden import GOLDEN_FOLDER

NODES = 9
VERTICES = (0, 3, 11)
DT_S = 1 / 30


def chain_matrix(seed: int = 7) -> np.ndarray:
    """(3n, 3n) N/m: a chain of nodes from the ground, each tied to the two below it."""
    rng = np.random.default_rng(seed)
    matrix = np.zeros((3 * (NODES + 1), 3 * (NODES + 1)))
    for k in range(1, NODES + 1):
        for below in (k - 1, k - 2):
            if below < 0:
                continue
            arm = rng.normal(size=(3, 3))
            block = 2e3 * (arm @ arm.T + 0.3 * np.eye(3))
            at = np.concatenate([3 * below + np.arange(3), 3 * k + np.arange(3)])
            matrix[np.ix_(at, at)] += np.kron([[1, -1], [-1, 1]], block)
    return matrix[3:, 3:]


def chain_factor() -> TangentFactor:
    """The factor of the chain; nodes are eliminated from the top, so that there is no fill-in."""
    matrix = chain_matrix()
    order = np.arange(NODES)[::-1]
    index = (3 * order[:, None] + np.arange(3)).ravel()
    lower = np.linalg.cholesky(matrix[np.ix_(index, index)])
    pointer, rows, blocks = [0], [], []
    for k in range(NODES):
        for i in range(k, min(k + 3, NODES)):
            block = lower[3 * i : 3 * i + 3, 3 * k : 3 * k + 3]
            if i == k:
                inverse = np.linalg.inv(block)
                block = np.zeros(9)
                block[:6] = inverse[[0, 1, 1, 2, 2, 2], [0, 0, 1, 0, 1, 2]]
            rows.append(i)
            blocks.append(np.ravel(block))
        pointer.append(len(rows))
    rank = np.concatenate([[NODES], np.argsort(order)])
    return TangentFactor(
        np.array(pointer, np.int32),
        np.array(rows, np.int32),
        np.array(blocks),
        rank.astype(np.int32),
        np.linspace(4.0, 9.0, NODES),
        np.linspace(30.0, 90.0, NODES),
    )


def compliance_for(table: Table) -> Compliance:
    """A compliance file whose vertices follow the chain, two nodes each; some also the ground."""
    factor = chain_factor()
    vertices = len(table.vertex_node)
    low = np.arange(vertices) % NODES
    node = np.stack([factor.rank[low], factor.rank[low + 1]] + [np.full(vertices, NODES)] * 2, axis=1)
    weight = np.tile([20000, 45535, 0, 0], (vertices, 1))
    return Compliance(
        mesh_sha256=str(table.metadata["mesh_sha256"]),
        pointer=factor.pointer.astype(np.uint32),
        rows=factor.rows.astype(np.uint16),
        blocks=factor.blocks.astype(np.float32),
        mass_kg=factor.mass_kg.astype(np.float32),
        limit_n=factor.limit_n.astype(np.float32),
        node=node.astype(np.uint16),
        weight=weight.astype(np.uint16),
        vertex_row=np.arange(vertices, dtype=np.uint32),
    )


def responses(table: Table, compliance: Compliance) -> list[dict[str, Any]]:
    """The response of some points, with the file and without it."""
    rows: list[dict[str, Any]] = []
    for vertex in VERTICES:
        whole, modes = point_response(table, vertex, compliance), point_response(table, vertex)
        rows.append(
            {
                "vertex": vertex,
                "oscillators": whole.oscillators.ravel().tolist(),
                "pose": whole.pose.ravel().tolist(),
                "compliance": whole.compliance.ravel().tolist(),
                "of_modes": modes.compliance.ravel().tolist(),
                "limit_n": whole.limit_n,
                "reach_m": whole.reach_m,
            }
        )
    return rows


def hand(table: Table, compliance: Compliance) -> dict[str, Any]:
    """A hand that follows a moving target while the wind moves its point; one row of forces per step."""
    pulling = DragConstraint(point_response(table, VERTICES[1], compliance))
    targets, swayed, forces = [], [], []
    for k in range(40):
        targets.append([0.002 * k, -0.05 if k > 20 else 0.01, 0.001 * k * k])
        swayed.append([0.01 * np.sin(0.3 * k), 0.0, 0.004])
        pulling.step(DT_S, np.array(targets[-1]), np.array(swayed[-1]))
        forces.append(pulling.force_n.tolist())
    e, v = pulling.released()
    rows = {"targets_m": targets, "swayed_m": swayed, "forces_n": forces}
    return {"vertex": VERTICES[1], "dt_s": DT_S, **rows, "e": e.tolist(), "v": v.tolist()}


def main() -> None:
    """Write the files."""
    table = decode((GOLDEN_FOLDER / "pole-table.safetensors").read_bytes())
    data = encode_compliance(compliance_for(table))
    (GOLDEN_FOLDER / "pole-compliance.safetensors").write_bytes(data)
    compliance = decode_compliance(data)
    golden = {"responses": responses(table, compliance), "hand": hand(table, compliance)}
    (GOLDEN_FOLDER / "pull.json").write_text(json.dumps(golden, separators=(",", ":")) + "\n")


if __name__ == "__main__":
    main()
