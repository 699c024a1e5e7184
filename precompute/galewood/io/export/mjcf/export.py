"""`--to mjcf`: a tree for MuJoCo that moves by itself, in MuJoCo's wind and gravity."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from galewood.io.export.errors import ExportError
from galewood.io.export.gltf_file import GltfFile
from galewood.io.export.mjcf.capsules import capsules
from galewood.io.export.mjcf.document import body_names, document
from galewood.io.export.mjcf.drag import SPEEDS_M_S, STEP_S, sheltered_speed
from galewood.io.export.mjcf.fitted import fitted_tree
from galewood.io.export.mjcf.skin import write_skins
from galewood.io.export.options import MOST_BONES
from galewood.table import Compliance, Table, TableError, decode_compliance

NEEDS_COMPLIANCE = "mjcf needs the compliance file of the tree, which says how its wood yields to forces: "


def readable_compliance(table: Table, data: bytes | None) -> Compliance:
    """The compliance file of a table's tree. ExportError if there is none, or another tree's."""
    if data is None:
        raise ExportError(
            NEEDS_COMPLIANCE
            + "builds write it beside the table, unless the tree is unstable or has too many nodes"
        )
    try:
        compliance = decode_compliance(data)
    except TableError as error:
        raise ExportError(f"the compliance file cannot be read: {error}") from None
    same = compliance.mesh_sha256 == table.metadata["mesh_sha256"]
    if not same or len(compliance.vertex_row) != len(table.vertex_joint):
        raise ExportError(NEEDS_COMPLIANCE + "this one belongs to another tree")
    return compliance


def export_mjcf(
    table: Table, glb: bytes, data: bytes | None, folder: Path, name: str, most: int = MOST_BONES
) -> dict[str, Any]:
    """Write NAME.xml, its skins and textures, and a description; return it. Raises ExportError."""
    compliance = readable_compliance(table, data)
    file = GltfFile(glb, table)
    rest_m = file.rest_m()
    fitted = fitted_tree(table, compliance, rest_m, file.faces(), most)
    folder.mkdir(parents=True, exist_ok=True)
    skins = write_skins(folder, name, table, file, fitted.tree, body_names(fitted.tree, name))
    height_m = float(table.metadata["height_m"])
    text = document(fitted, capsules(fitted.tree, table, rest_m), skins, name, height_m)
    (folder / f"{name}.xml").write_text(text)
    description: dict[str, Any] = {
        "format": "galewood-mjcf",
        "version": 1,
        "model": f"{name}.xml",
        "bodies": fitted.tree.count,
        "mass_kg": float(fitted.masses.mass_kg.sum()) + fitted.ground_kg,
        "height_m": height_m,
        "timestep_s": STEP_S,
        "frequencies_hz": [float(f) for f in table.metadata["frequencies_hz"]],
        "wind_m_s": {str(speed): sheltered_speed(table, speed) for speed in SPEEDS_M_S},
        "measured": fitted.measured,
    }
    (folder / f"{name}.json").write_text(json.dumps(description, indent=2) + "\n")
    return description
