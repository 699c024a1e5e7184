"""Iterative traversal of the glTF node tree: placement and names of all meshes."""

from __future__ import annotations

from typing import Any

import numpy as np

from galewood.util import Floats, MeshError

Json = dict[str, Any]
MAX_DEPTH = 256
MAX_VISITS = 100_000


def mesh_instances(document: Json) -> list[tuple[Json, tuple[str, ...], Floats]]:
    """(mesh, (node name, mesh name), world matrix (4, 4)) of every mesh in the default scene."""
    found: list[tuple[Json, tuple[str, ...], Floats]] = []
    nodes: list[Json] = document.get("nodes", [])
    stack = [(index, np.eye(4), 0) for index in reversed(_roots(document, nodes))]
    visits = 0
    while stack:
        index, parent, depth = stack.pop()
        visits += 1
        if depth > MAX_DEPTH or visits > MAX_VISITS:
            raise MeshError(
                "nodes-too-deep",
                "unsuitable",
                f"The nodes of the glTF are nested deeper than {MAX_DEPTH} levels or form a cycle.",
                "Apply the transforms and export a single mesh.",
            )  # fmt: skip
        if index < 0:
            raise IndexError(f"node {index}")
        node = nodes[index]
        world = parent @ _local(node)
        if "mesh" in node:
            mesh = document["meshes"][node["mesh"]]
            names = tuple(str(n) for n in (node.get("name"), mesh.get("name")) if n)
            found.append((mesh, names, world))
        stack.extend((child, world, depth + 1) for child in reversed(node.get("children", [])))
    return found


def _roots(document: Json, nodes: list[Json]) -> list[int]:
    scenes = document.get("scenes")
    if scenes:
        return list(scenes[document.get("scene", 0)].get("nodes", []))
    children = {c for node in nodes for c in node.get("children", [])}
    return [i for i in range(len(nodes)) if i not in children]


def _local(node: Json) -> Floats:
    if "matrix" in node:
        return np.array(node["matrix"], dtype=np.float64).reshape(4, 4).T
    matrix = np.eye(4)
    x, y, z, w = _unit([float(c) for c in node.get("rotation", (0, 0, 0, 1))])
    rotation = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    matrix[:3, :3] = rotation * np.array(node.get("scale", (1, 1, 1)), dtype=np.float64)
    matrix[:3, 3] = np.array(node.get("translation", (0, 0, 0)), dtype=np.float64)
    return matrix


def _unit(quaternion: list[float]) -> list[float]:
    length = sum(c * c for c in quaternion) ** 0.5
    return [c / length for c in quaternion] if length > 0 else [0.0, 0.0, 0.0, 1.0]
