"""`--to mjcf`: a tree for MuJoCo that moves by itself, in MuJoCo's wind and gravity."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from galewood.io.export.mjcf.document import document
from galewood.io.export.mjcf.skin import write_skins
from galewood.io.export.options import MOST_BONES
from galewood.io.export.rigid.bodies import body_names
from galewood.io.export.rigid.capsules import capsules
from galewood.io.export.rigid.prepared import prepared
from galewood.table import Table


def export_mjcf(
    table: Table, glb: bytes, data: bytes | None, folder: Path, name: str, most: int = MOST_BONES
) -> dict[str, Any]:
    """Write NAME.xml, its skins and textures, and a description; return it. Raises ExportError."""
    ready = prepared(table, glb, data, most, "mjcf", name)
    fitted = ready.fitted
    folder.mkdir(parents=True, exist_ok=True)
    skins = write_skins(folder, name, table, ready.file, fitted.tree, body_names(fitted.tree, name))
    text = document(fitted, capsules(fitted.tree, table, ready.rest_m), skins, name, ready.height_m)
    (folder / f"{name}.xml").write_text(text)
    description = {"format": "galewood-mjcf", "version": 1, "model": f"{name}.xml", **ready.description}
    (folder / f"{name}.json").write_text(json.dumps(description, indent=2) + "\n")
    return description
