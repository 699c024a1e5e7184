"""`--to urdf`: a tree as a robot description, with the springs of its joints beside it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from galewood.io.export.options import MOST_BONES
from galewood.io.export.rigid.bodies import HINGES, body_names
from galewood.io.export.rigid.capsules import capsules
from galewood.io.export.rigid.fitted import FittedTree
from galewood.io.export.rigid.prepared import prepared
from galewood.io.export.urdf.document import SMALL_SHARE, document
from galewood.io.export.urdf.meshes import write_meshes
from galewood.solid.model import GRAVITY_M_S2
from galewood.table import Table
from galewood.util import Floats


def export_urdf(
    table: Table, glb: bytes, data: bytes | None, folder: Path, name: str, most: int = MOST_BONES
) -> dict[str, Any]:
    """Write NAME.urdf, the meshes of its links, and a description with springs; return it. ExportError."""
    ready = prepared(table, glb, data, most, "urdf", name)
    fitted = ready.fitted
    folder.mkdir(parents=True, exist_ok=True)
    drawn = write_meshes(folder, name, table, ready.file, fitted.tree, body_names(fitted.tree, name))
    text = document(fitted, capsules(fitted.tree, table, ready.rest_m), drawn, name)
    (folder / f"{name}.urdf").write_text(text)
    description = {
        "format": "galewood-urdf",
        "version": 1,
        "model": f"{name}.urdf",
        **ready.description,
        "joints": _springs(fitted, name),
    }
    (folder / f"{name}.json").write_text(json.dumps(description, indent=2) + "\n")
    return description


def _springs(fitted: FittedTree, name: str) -> dict[str, dict[str, float]]:
    """Stiffness, damping and free angle of each joint, by its name."""
    reference = free_angles(fitted)
    return {
        f"{body}_{hinge}": {
            "stiffness_n_m_rad": float(fitted.stiffness[3 * index + axis]),
            "damping_n_m_s_rad": float(fitted.damping[3 * index + axis]),
            "reference_rad": float(reference[3 * index + axis]),
        }
        for index, body in enumerate(body_names(fitted.tree, name)[:-1])
        for axis, hinge in enumerate(HINGES)
    }


def free_angles(fitted: FittedTree) -> Floats:
    """(3b,) rad: where each spring is free, as a joint carries no weight of the small links before it."""
    weight = GRAVITY_M_S2 * fitted.masses.mass_kg[:, None] * (fitted.masses.centre_m - fitted.tree.hinge_m)
    torque = -np.cross(fitted.tree.axes, weight[:, None])[:, :, 1]
    less = SMALL_SHARE * np.arange(len(HINGES)) * torque
    free: Floats = fitted.reference_rad + less.ravel() / fitted.stiffness
    return free
