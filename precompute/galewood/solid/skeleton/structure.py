"""The finite-element mesh and the skeleton of a tree as JSON, for display."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from galewood.sandbox import Arrays, Limits, run_limited
from galewood.solid.skeleton.extraction import extract_skeleton
from galewood.solid.tets import TetMesh

LIMITS = Limits(memory_bytes=4 << 30, cpu_s=60)
LENGTH_DIGITS = 4  # of lengths in m


def structure_limited(tetrahedra: Path) -> bytes:
    """The structure of a tree from the file of its tetrahedra, computed in a child process with limits.

    JSON: vertices_m (n × 3), tets (m × 4), and the skeleton: points_m (p × 3), parent (p) with −1 at the
    root, radius_m (p); all in metres, tree frame. Raises MeshError, and OSError, KeyError, ValueError or
    BadZipFile for a file that is missing or damaged.
    """
    with np.load(tetrahedra, allow_pickle=False) as stored:
        arguments = {name: stored[name] for name in ("vertices", "tets", "radius_ratio")}
    return run_limited(
        "galewood.solid.skeleton.structure:structure_in_child",
        arguments,
        LIMITS,
        what="Extracting the skeleton",
    )["json"].tobytes()


def structure_in_child(arguments: Arrays) -> Arrays:
    """Entry point of the child process of ``structure_limited``."""
    mesh = TetMesh(arguments["vertices"], arguments["tets"], arguments["radius_ratio"], {})
    skeleton = extract_skeleton(mesh)
    structure = {
        "vertices_m": mesh.vertices_m.round(LENGTH_DIGITS).tolist(),
        "tets": mesh.tets.tolist(),
        "skeleton": {
            "parent": skeleton.parent.tolist(),
            "points_m": skeleton.points_m.round(LENGTH_DIGITS).tolist(),
            "radius_m": skeleton.radius_m.round(LENGTH_DIGITS).tolist(),
        },
    }
    text = json.dumps(structure, separators=(",", ":")).encode()
    return {"json": np.frombuffer(text, np.uint8)}
