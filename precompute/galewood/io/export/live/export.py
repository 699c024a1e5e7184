"""`--to live`: morph targets that a behaviour graph moves, in a wind that programs can set."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from galewood.io.export.glb import MEASURED_POSES, add_morphs, linear_error_percent
from galewood.io.export.gltf_file import GltfFile
from galewood.io.export.gltf_names import give_names
from galewood.io.export.live.deviation import Targets, live_deviation
from galewood.io.export.live.extension import EXTENSION_NAME, extension_of
from galewood.io.export.live.graph import WIND_EVENT, behaviour_of
from galewood.io.export.live.gusts import live_gusts
from galewood.io.export.live.model import live_model
from galewood.io.export.looped import Loop, seam
from galewood.table import Table

INTERACTIVITY_NAME = "KHR_interactivity"


def export_live(table: Table, glb: bytes, loop: Loop, folder: Path, name: str) -> dict[str, Any]:
    """Write the GLB, which also holds the loop for programs without the extensions, and a description.

    Returns the description. Raises ExportError.
    """
    file = GltfFile(glb, table)
    give_names(file.gltf, name)
    rest_m, oscillators = file.rest_m(), len(table.modal_step)
    height_m = float(table.metadata["height_m"])
    modes, scale_m = add_morphs(file, table, rest_m, loop, f"{name}_sway", oscillators)
    model, gusts = live_model(table, modes, scale_m), live_gusts(loop.wind, height_m)
    nodes = [index for index, node in enumerate(file.gltf.nodes) if node.mesh is not None]
    graph = behaviour_of(model, gusts, nodes, f"{name}_live")
    file.extend(INTERACTIVITY_NAME, {"graphs": [graph], "graph": 0})
    file.extend(EXTENSION_NAME, extension_of(model, gusts), {node: {"model": 0} for node in nodes})
    poses = loop.q()[:: max(1, loop.frames // MEASURED_POSES)]
    description: dict[str, Any] = {
        "format": "galewood-live",
        "version": 1,
        "mesh": f"{name}.glb",
        "animation": f"{name}_sway",
        "variables": [variable["extras"]["name"] for variable in graph["variables"][:2]],
        "event": WIND_EVENT,
        "modes": modes.tolist(),
        "scale_m": scale_m.tolist(),
        "graph_nodes": len(graph["nodes"]),
        **loop.about(table),
        "measured": {
            "loop_error_percent_of_height": linear_error_percent(table, rest_m, poses, oscillators),
            **seam(table, rest_m, loop),
            **live_deviation(table, rest_m, loop.wind, gusts, model, Targets(modes, scale_m)),
        },
    }
    file.note("galewood_live", description)
    (folder / f"{name}.glb").write_bytes(file.glb())
    (folder / f"{name}.json").write_text(json.dumps(description, indent=2) + "\n")
    return description
