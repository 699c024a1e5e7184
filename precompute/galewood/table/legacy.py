"""Conversion of older table files to the present version, when they are read."""

from __future__ import annotations

import numpy as np

from galewood.table.container import Metadata, TableError
from galewood.table.records import poses
from galewood.util import Array

PAPER_NAMES = (
    "records",
    "points",
    "components",
    "sampled_elements",
    "sigma_pa",
    "weight",
    "pose_easing",
)
"""Metadata that versions 5 and 6 kept beside the others."""
REACH_MARGIN = 1.25


def upgraded(metadata: Metadata, tensors: dict[str, Array]) -> tuple[Metadata, dict[str, Array]]:
    """Metadata and tensors of a file of version 5 to 9 in the layout of version 10."""
    if metadata.get("version") == 5:
        metadata, tensors = _from_version_5(metadata, tensors)
    if metadata.get("version") == 6:
        metadata = _from_version_6(metadata, tensors)
    if metadata.get("version") == 7:
        metadata, tensors = {**metadata, "version": 8}, tensors | _without_drag(tensors)
    if metadata.get("version") == 8:
        metadata, tensors = {**metadata, "version": 9}, tensors | _without_gusts()
    if metadata.get("version") == 9:
        metadata, tensors = {**metadata, "version": 10}, _without_joints(tensors)
    return metadata, tensors


def _without_drag(tensors: dict[str, Array]) -> dict[str, Array]:
    """The tensors that version 8 added: no drag points, so the wind's force does not depend on the motion."""
    d = len(tensors.get("modal.step", ()))
    return {
        "modal.drag_point": np.zeros((0, 2), np.float32),
        "modal.drag_shape": np.zeros((3, 0, d), np.float32),
        "modal.drag_rest": np.zeros(d, np.float32),
    }


def _without_gusts() -> dict[str, Array]:
    """The tensors that version 9 added: no gust layer, so each tree feels one pressure."""
    shapes = {"place": (0, 3), "step": (0, 6), "load": (0, 0), "drag": (0,)}
    return {f"gusts.{name}": np.zeros(shape, np.float32) for name, shape in shapes.items()}


def _without_joints(tensors: dict[str, Array]) -> dict[str, Array]:
    """Version 10 binds vertices to joints between nodes that turn; before, to a node that does not."""
    kept = {name: tensor for name, tensor in tensors.items() if name != "render.vertex_node"}
    if "render.vertex_node" not in tensors:
        raise TableError("missing tensor render.vertex_node")
    if "nodes.rest_m" not in tensors or "nodes.basis" not in tensors:
        return kept  # the reader names what is missing
    count = len(tensors["nodes.rest_m"])
    own = np.arange(count).astype(np.uint16)
    return kept | {
        "nodes.turn": np.zeros_like(tensors["nodes.basis"]),
        "nodes.parent": own,
        "joints.nodes": np.column_stack([own, own]),
        "joints.share": np.zeros(count, np.float32),
        "joints.rest_m": tensors["nodes.rest_m"],
        "render.vertex_joint": tensors["render.vertex_node"],
    }


def _from_version_5(metadata: Metadata, tensors: dict[str, Array]) -> tuple[Metadata, dict[str, Array]]:
    """Version 6 renamed the modal model's tensors and its error; layout and values are the same."""
    errors = metadata.get("errors")
    if isinstance(errors, dict) and "replay_m" in errors:
        kept = {name: value for name, value in errors.items() if name != "replay_m"}
        metadata = {**metadata, "errors": {**kept, "training_m": errors["replay_m"]}}
    renamed = {name.replace("tangent.", "modal.", 1): tensor for name, tensor in tensors.items()}
    return {**metadata, "version": 6}, renamed


def _from_version_6(metadata: Metadata, tensors: dict[str, Array]) -> Metadata:
    """Version 7 made the records of the paper's search optional and stores what was derived from them."""
    paper = {name: metadata[name] for name in PAPER_NAMES if name in metadata}
    winds = _provenance(metadata, "winds")
    frames = _provenance(metadata, "frames")
    kept = {name: value for name, value in metadata.items() if name not in PAPER_NAMES}
    count = max(len(tensors.get("samples.trajectory", ())) - 1, 0)
    return {
        **kept,
        "version": 7,
        "paper": {**paper, "winds": winds[:count], "frames": frames[:count]},
        "peak_pressure_pa": _peak_pa(tensors),
        "reach_m": _reach_m(tensors),
    }


def _provenance(metadata: Metadata, name: str) -> list[object]:
    provenance = metadata.get("provenance")
    found = provenance.get(name) if isinstance(provenance, dict) else None
    return found if isinstance(found, list) else []


def _peak_pa(tensors: dict[str, Array]) -> float:
    from galewood.wind import sampled_peak_pa  # loads compiled kernels, which only old files need

    pressure = np.asarray(tensors.get("samples.pressure_pa", np.zeros((1, 2))), np.float32)
    if pressure.ndim != 2 or pressure.shape[1] != 2 or not len(pressure):
        raise TableError("tensor samples.pressure_pa: expected float32 of rank 2")
    return sampled_peak_pa(pressure)


def _reach_m(tensors: dict[str, Array]) -> float:
    """Largest displacement of any node over the poses of all records, with a margin, m."""
    try:
        basis = tensors["nodes.basis"]
        q = poses(tensors["samples.dq"], tensors["samples.trajectory"]) * tensors["modes.scale"]
        largest = max(float(np.linalg.norm(q @ node.T, axis=1).max()) for node in basis)
        return max(REACH_MARGIN * largest, 1e-6)
    except (KeyError, ValueError, IndexError) as error:
        raise TableError(f"damaged table file: {error}") from error
