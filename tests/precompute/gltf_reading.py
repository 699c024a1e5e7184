"""Reads GLB files with nothing but the glTF 2.0 specification, to check what others wrote."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

WIDTH = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
KIND = {5121: "u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}


class Glb:
    """The JSON document of a GLB, and its accessors."""

    def __init__(self, path: Path) -> None:
        data = path.read_bytes()
        size = int.from_bytes(data[12:16], "little")
        self.document: dict[str, Any] = json.loads(data[20 : 20 + size])
        self._binary = data[28 + size :]

    def rows(self, index: int) -> Any:
        """(n, k) the values of an accessor."""
        about = self.document["accessors"][index]
        view = self.document["bufferViews"][about["bufferView"]]
        width = WIDTH[about["type"]]
        start = view.get("byteOffset", 0) + about.get("byteOffset", 0)
        kind = KIND[about["componentType"]]
        return np.frombuffer(self._binary, kind, about["count"] * width, start).reshape(-1, width)

    def attribute(self, name: str) -> Any:
        """(v, k) a vertex attribute of all meshes, one after another."""
        meshes = self.document["meshes"]
        return np.concatenate([self.rows(mesh["primitives"][0]["attributes"][name]) for mesh in meshes])

    def skinned(self, time_s: float) -> Any:
        """(v, 3) vertices at a time of the first animation, by the formulas of section 3.7.3.3."""
        nodes, skin = list(self.document["nodes"]), self.document["skins"][0]
        local = [_matrix(node.get("translation"), node.get("rotation")) for node in nodes]
        for node, path, value in self._tracks(time_s):
            nodes[node] = {**nodes[node], path: value}
            local[node] = _matrix(nodes[node].get("translation"), nodes[node].get("rotation"))
        world = dict[int, Any]()
        order = [(node, np.eye(4)) for node in self.document["scenes"][0]["nodes"]]
        while order:
            node, above = order.pop()
            world[node] = above @ local[node]
            order += [(child, world[node]) for child in nodes[node].get("children", [])]
        inverse = self.rows(skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1)
        bones = np.stack([world[joint] @ inverse[k] for k, joint in enumerate(skin["joints"])])
        rest, used, share = (self.attribute(name) for name in ("POSITION", "JOINTS_0", "WEIGHTS_0"))
        blended = np.einsum("vk,vkab->vab", share.astype(np.float64), bones[used])
        return np.einsum("vab,vb->va", blended, np.c_[rest, np.ones(len(rest))])[:, :3]

    def _tracks(self, time_s: float) -> list[tuple[int, str, list[float]]]:
        animation, found = self.document["animations"][0], list[tuple[int, str, list[float]]]()
        for channel in animation["channels"]:
            sampler = animation["samplers"][channel["sampler"]]
            times, values = self.rows(sampler["input"])[:, 0], self.rows(sampler["output"])
            value = np.array([np.interp(time_s, times, column) for column in values.T.astype(np.float64)])
            if channel["target"]["path"] == "rotation":
                value /= np.linalg.norm(value)
            found.append((channel["target"]["node"], channel["target"]["path"], value.tolist()))
        return found


def _matrix(translation: list[float] | None, rotation: list[float] | None) -> Any:
    found = np.eye(4)
    x, y, z, w = rotation or (0.0, 0.0, 0.0, 1.0)
    found[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    found[:3, 3] = translation or (0.0, 0.0, 0.0)
    return found
