"""Skins at rest: each vertex is placed by its joints, as the file shows it without animation.

Source: glTF 2.0 specification, section 3.7.3: the transform of the node with the skinned mesh is ignored.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from galewood.formats.gltf.document import GltfDocument, broken
from galewood.formats.gltf.material import natural
from galewood.formats.gltf.primitive import Influences
from galewood.formats.gltf.scene import world_matrices
from galewood.util import Floats, MeshError

Json = dict[str, Any]
MAX_JOINTS = 10_000


class Skins:
    """Joint matrices of the document's skins, calculated when first used."""

    def __init__(self, document: GltfDocument) -> None:
        self._document = document
        self._world: dict[int, Floats] | None = None
        self._joints: dict[int, Floats] = {}

    def vertex_matrices(self, skin: int, influences: Influences) -> Floats:
        """The matrix (n, 4, 4) that places each vertex: the weighted mean of those of its joints."""
        joints = self._joint_matrices(skin)
        if influences.joints.size and int(influences.joints.max()) >= len(joints):
            raise broken("gltf-structure", "A vertex refers to a joint that does not exist.")
        total = np.zeros((len(influences.joints), 4, 4))
        for column in range(influences.joints.shape[1]):  # one after another: needs less memory
            weight = influences.weights[:, column, None, None]
            total += weight * joints[influences.joints[:, column]]
        return total

    def _joint_matrices(self, index: int) -> Floats:
        if index not in self._joints:
            self._joints[index] = self._read(self._document.json["skins"][natural(index)])
        return self._joints[index]

    def _read(self, skin: Json) -> Floats:
        if self._world is None:
            self._world = world_matrices(self._document.json)
        nodes = [natural(node) for node in skin["joints"]]
        if len(nodes) > MAX_JOINTS:
            raise MeshError(
                "too-many-joints", "too-large", f"A skin has {len(nodes)} joints; the limit is {MAX_JOINTS}.",
                "Apply the armature and export the mesh without it.",
            )  # fmt: skip
        count = len(self._document.json["nodes"])
        if any(node not in self._world and node < count for node in nodes):
            raise MeshError(
                "skin-cycle", "unsuitable", "The joints of a skin form a cycle.",
                "Apply the armature and export the mesh without it.",
            )  # fmt: skip
        world = np.array([self._world[node] for node in nodes]).reshape(-1, 4, 4)
        if "inverseBindMatrices" not in skin:
            return world
        inverse = self._document.floats(skin["inverseBindMatrices"])
        if inverse is None or inverse.shape[1] != 16 or len(inverse) < len(nodes):
            raise broken("gltf-structure", "A skin has fewer inverse bind matrices than joints.")
        return world @ inverse[: len(nodes)].reshape(-1, 4, 4).transpose(0, 2, 1)
