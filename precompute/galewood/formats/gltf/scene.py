"""Iterative traversal of the glTF node tree: placement and names of all meshes."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import chain
from typing import Any

import numpy as np

from galewood.formats.graph_depth import MAX_COPIES, problem_of
from galewood.util import Floats, MeshError

Json = dict[str, Any]


@dataclass(frozen=True)
class Placed:
    """A node with a mesh in the default scene: its names and its world matrix (4, 4)."""

    node: Json
    mesh: Json
    names: tuple[str, ...]  # of the node and of the mesh
    world: Floats


def placed_meshes(document: Json) -> list[Placed]:
    """All meshes of the default scene. MeshError for a cycle of nodes, too many or too deep ones."""
    nodes: list[Json] = document.get("nodes", [])
    found: list[Placed] = []
    for index, world in _walk(nodes, _roots(document, nodes)):
        node = nodes[index]
        if "mesh" in node:
            mesh = document["meshes"][node["mesh"]]
            names = tuple(str(n) for n in (node.get("name"), mesh.get("name")) if n)
            found.append(Placed(node, mesh, names, world))
    return found


def world_matrices(document: Json) -> dict[int, Floats]:
    """World matrix (4, 4) of every node, in the default scene or not; those in a cycle have none."""
    nodes: list[Json] = document.get("nodes", [])
    return dict(_walk(nodes, _parentless(nodes)))


def _walk(nodes: list[Json], roots: list[int]) -> list[tuple[int, Floats]]:
    """The nodes below the roots with their world matrices; a node with several parents once for each.

    The specification demands a tree (section 3.5.1), but some exporters share nodes, or repeat roots.
    """
    if max(len(nodes), len(roots)) > MAX_COPIES:
        raise _unsuitable("too-many-nodes", f"The glTF has more than {MAX_COPIES} nodes.")
    roots = list(dict.fromkeys(roots))
    below: list[list[int]] = [node.get("children", []) for node in nodes]
    for index in (*roots, *chain.from_iterable(below)):
        if index >= len(nodes):
            raise IndexError(f"node {index}")
    problem = problem_of(below, roots)
    if problem:
        raise _unsuitable("nested-too-deep", f"The nodes of the glTF {problem}.")
    local = _local_matrices(nodes)
    found: list[tuple[int, Floats]] = []
    stack = [(index, np.eye(4)) for index in reversed(roots)]
    while stack:
        index, parent = stack.pop()
        world = parent @ local[index]
        found.append((index, world))
        if len(found) > MAX_COPIES:
            raise _unsuitable("too-many-nodes", f"The glTF has more than {MAX_COPIES} nodes.")
        stack.extend((child, world) for child in reversed(below[index]))
    return found


def _unsuitable(code: str, title: str) -> MeshError:
    return MeshError(code, "unsuitable", title, "Apply the transforms and export a single mesh.")


def _roots(document: Json, nodes: list[Json]) -> list[int]:
    scenes = document.get("scenes")
    if scenes:
        return list(scenes[document.get("scene", 0)].get("nodes", []))
    return _parentless(nodes)


def _parentless(nodes: list[Json]) -> list[int]:
    children = {c for node in nodes for c in node.get("children", [])}
    return [i for i in range(len(nodes)) if i not in children]


def _local_matrices(nodes: list[Json]) -> Floats:
    """The matrix (n, 4, 4) of each node relative to its parent."""
    translation, rotation, scale = (
        np.array([node.get(key, default) for node in nodes], dtype=np.float64).reshape(-1, len(default))
        for key, default in (
            ("translation", (0.0, 0.0, 0.0)),
            ("rotation", (0.0, 0.0, 0.0, 1.0)),
            ("scale", (1.0, 1.0, 1.0)),
        )
    )
    matrices = composed(translation, rotation, scale)
    for index, node in enumerate(nodes):
        if "matrix" in node:
            matrices[index] = np.array(node["matrix"], dtype=np.float64).reshape(4, 4).T
    return matrices


def composed(translation: Floats, quaternion: Floats, scale: Floats) -> Floats:
    """Matrices (n, 4, 4) that scale (n, 3), then rotate (n, 4: x, y, z, w), then translate (n, 3)."""
    length = np.linalg.norm(quaternion, axis=1, keepdims=True)
    unit = np.where(length > 0, quaternion / np.where(length > 0, length, 1.0), (0.0, 0.0, 0.0, 1.0))
    x, y, z, w = unit.T
    matrix = np.zeros((len(unit), 4, 4))
    matrix[:, 0, :3] = np.column_stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)])
    matrix[:, 1, :3] = np.column_stack([2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)])
    matrix[:, 2, :3] = np.column_stack([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)])
    matrix[:, :3, :3] *= scale[:, None, :]
    matrix[:, :3, 3] = translation
    matrix[:, 3, 3] = 1.0
    return matrix
