"""Files of the coarser levels of detail of an exported tree."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from galewood.constants import LEVEL_SHARES
from galewood.io.export.engine.pieces import leaf_pieces, wood_pieces
from galewood.io.export.errors import ExportError
from galewood.io.export.gltf_file import GltfFile
from galewood.table import Table


def write_levels(file: GltfFile, table: Table, folder: Path, name: str, count: int) -> list[dict[str, Any]]:
    """Write NAME_lod1.glb and so on, and describe all levels; meshes get names that end with _LOD0, _LOD1, …

    Level k shows the share LEVEL_SHARES[k] of leaves and twigs, in the order of the player. Vertices of what
    it does not show are left out; everything else, such as a skeleton and skin weights, is as in ``file``,
    which becomes level 0.

    Args:
        file: The complete tree, without animations: those of level 0 fit all.
        table: Its table.
        folder: Where to write.
        name: Name of the files.
        count: Number of levels; 1 changes and writes nothing.

    Raises:
        ExportError: The tree has no leaves, so that its levels would not differ.
    """
    kinds = [str(primitive["kind"]) for primitive in table.metadata["primitives"]]
    if count == 1:
        return []
    if "leaves" not in kinds:
        raise ExportError("a tree without leaves stays complete at every level of detail: use levels 1")
    complete, described = file.glb(), [_about(file, f"{name}.glb", LEVEL_SHARES[0])]
    _name_level(file, 0)
    for level, share in list(enumerate(LEVEL_SHARES))[1:count]:
        coarser = GltfFile(complete, table)
        _reduce(coarser, kinds, share)
        _name_level(coarser, level)
        coarser.drop_unused()
        (folder / f"{name}_lod{level}.glb").write_bytes(coarser.glb())
        described.append(_about(coarser, f"{name}_lod{level}.glb", share))
    return described


def _reduce(file: GltfFile, kinds: list[str], share: float) -> None:
    rest = np.split(file.rest_m(), np.cumsum(file.counts)[:-1])
    for part, (rest_m, faces, kind) in enumerate(zip(rest, file.faces(), kinds, strict=True)):
        pieces = (leaf_pieces if kind == "leaves" else wood_pieces)(rest_m, faces)
        size, anchor_m = pieces.shown(share)[pieces.of_vertex], pieces.anchor_m[pieces.of_vertex]
        file.keep(part, size > 0, anchor_m + size[:, None] * (rest_m - anchor_m))


def _about(file: GltfFile, mesh: str, share: float) -> dict[str, Any]:
    triangles = [len(faces) for faces in file.faces()]
    return {"mesh": mesh, "share": share, "triangles": sum(triangles), "vertices": sum(file.counts)}


def _name_level(file: GltfFile, level: int) -> None:
    for node in file.gltf.nodes:
        if node.mesh is not None:
            mesh = file.gltf.meshes[node.mesh]
            mesh.name = node.name = f"{node.name}_LOD{level}"
