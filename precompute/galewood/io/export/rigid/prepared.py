"""What the exports of rigid bodies have in common: the fitted tree, its drawn mesh, its description."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from galewood.io.export.errors import ExportError
from galewood.io.export.gltf_file import GltfFile
from galewood.io.export.rigid.bodies import body_names, upright
from galewood.io.export.rigid.drag import AIR_KG_M3, SPEEDS_M_S, STEP_S, sheltered_speed
from galewood.io.export.rigid.fitted import FittedTree, fitted_tree
from galewood.table import Compliance, Table, TableError, decode_compliance
from galewood.util import Floats


@dataclass(frozen=True)
class Prepared:
    """A tree, ready to be written."""

    file: GltfFile
    rest_m: Floats
    """(v, 3) vertices of the drawn mesh."""
    fitted: FittedTree
    height_m: float
    description: dict[str, Any]
    """Of the bodies, as JSON, without the names of files."""


def prepared(table: Table, glb: bytes, data: bytes | None, most: int, kind: str, name: str) -> Prepared:
    """The rigid bodies of a table, at most ``most``, fitted to its compliance file ``data``; called NAME_….

    Raises:
        ExportError: The mesh is another tree's, or the compliance file is or is missing: ``kind`` needs it.
    """
    compliance = _readable_compliance(table, data, kind)
    file = GltfFile(glb, table)
    rest_m = file.rest_m()
    fitted = fitted_tree(table, compliance, rest_m, file.faces(), most)
    height_m = float(table.metadata["height_m"])
    description = {
        "bodies": fitted.tree.count,
        "mass_kg": float(fitted.masses.mass_kg.sum()) + fitted.ground_kg,
        "height_m": height_m,
        "timestep_s": STEP_S,
        "frequencies_hz": [float(f) for f in table.metadata["frequencies_hz"]],
        "wind_m_s": {str(speed): sheltered_speed(table, speed) for speed in SPEEDS_M_S},
        "air_kg_m3": AIR_KG_M3,
        "links": _areas(fitted, name),
        "measured": fitted.measured,
    }
    return Prepared(file, rest_m, fitted, height_m, description)


def _areas(fitted: FittedTree, name: str) -> dict[str, dict[str, Any]]:
    """Area in the wind of each body, and its centre from the body's origin, z up, by its name."""
    arm = upright(fitted.area_centre_m - fitted.tree.hinge_m)
    return {
        body: {"area_m2": float(fitted.area_m2[index]), "centre_m": arm[index].tolist()}
        for index, body in enumerate(body_names(fitted.tree, name)[:-1])
    }


def _readable_compliance(table: Table, data: bytes | None, kind: str) -> Compliance:
    """The compliance file of a table's tree. ExportError if there is none, or another tree's."""
    needs = f"{kind} needs the compliance file of the tree, which says how its wood yields to forces: "
    if data is None:
        raise ExportError(
            needs + "builds write it beside the table, unless the tree is unstable or has too many nodes"
        )
    try:
        compliance = decode_compliance(data)
    except TableError as error:
        raise ExportError(f"the compliance file cannot be read: {error}") from None
    same = compliance.mesh_sha256 == table.metadata["mesh_sha256"]
    if not same or len(compliance.vertex_row) != len(table.vertex_joint):
        raise ExportError(needs + "this one belongs to another tree")
    return compliance
