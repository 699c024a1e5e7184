"""Places of a node's mesh: one, or those of EXT_mesh_gpu_instancing."""

from __future__ import annotations

import numpy as np

from galewood.formats.gltf.document import GltfDocument, broken
from galewood.formats.gltf.material import natural
from galewood.formats.gltf.scene import Placed, composed
from galewood.util import Floats, MeshError

EXTENSION_NAME = "EXT_mesh_gpu_instancing"
MAX_INSTANCES = 100_000
IDENTITY_TRANSFORM = {
    "TRANSLATION": (0.0, 0.0, 0.0),
    "ROTATION": (0.0, 0.0, 0.0, 1.0),
    "SCALE": (1.0, 1.0, 1.0),
}


def instance_matrices(document: GltfDocument, placed: Placed) -> Floats:
    """World matrices (k, 4, 4) of all places at which a node's mesh is drawn."""
    extension = placed.node.get("extensions", {}).get(EXTENSION_NAME)
    if extension is None:
        return placed.world[None]
    attributes: dict[str, int] = extension["attributes"]
    accessors = document.json["accessors"]
    counts = {
        natural(accessors[natural(i)]["count"])
        for name, i in attributes.items()
        if name in IDENTITY_TRANSFORM
    }
    if len(counts) != 1:
        raise broken("gltf-structure", "The attributes of the instances differ in length.")
    count = counts.pop()
    if count > MAX_INSTANCES:
        raise MeshError(
            "too-many-instances",
            "too-large",
            f"A mesh is drawn {count} times; the limit is {MAX_INSTANCES}.",
            "Export a single tree, with fewer instances.",
        )
    rows = {name: _rows(document, attributes.get(name), name, count) for name in IDENTITY_TRANSFORM}
    return placed.world @ composed(rows["TRANSLATION"], rows["ROTATION"], rows["SCALE"])


def _rows(document: GltfDocument, index: int | None, name: str, count: int) -> Floats:
    values = document.floats(index)
    if values is None:
        return np.tile(np.array(IDENTITY_TRANSFORM[name]), (count, 1))
    if values.shape[1] != len(IDENTITY_TRANSFORM[name]):
        raise broken("gltf-structure", f"The {name} of the instances has a wrong type.")
    return values
