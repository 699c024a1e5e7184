"""Metadata of a table, and the report of a build."""

from __future__ import annotations

import hashlib
from dataclasses import asdict, dataclass
from importlib import metadata
from typing import Any

import numpy as np

from galewood.pipeline.sampling import DesignWind, content_hash
from galewood.pipeline.tables.options import BuildOptions
from galewood.pipeline.tables.summary import figures_of
from galewood.solid.fem import FemModel
from galewood.solid.model import TreeModel
from galewood.solid.skinning import is_torn, stretch_words
from galewood.table import Metadata, Records, Table
from galewood.tree import TreeMesh

ERRORS_IN = (
    "the training winds, which are the same over the whole crown; "
    "`galewood evaluate` measures the error in gusts that differ within it"
)
"""What the errors in the report of a build refer to."""


@dataclass(frozen=True)
class Body:
    """What a table says of the model it was made from: frequencies, wood, exponent, size and identity."""

    frequencies_hz: list[float]
    wood: str
    streamlined_exponent: float
    identity: dict[str, Any]


def body_of(model: FemModel) -> Body:
    """The description of a finite-element model."""
    identity = {
        "tetrahedra": len(model.elements),
        "model_sha256": content_hash(model),
        "young_longitudinal_pa": model.report["wood_constants"]["young_longitudinal_pa"],
    }
    return Body(model.report["frequencies_hz"], model.report["wood"], model.streamlined_exponent, identity)


def has_leaves(tree: TreeMesh, options: BuildOptions) -> bool:
    """Whether the model of a build has leaves: the mesh has some, and they are not left out."""
    return options.foliage == "leaf" and any(part.kind == "leaves" for part in tree.primitives)


def describe(
    tree: TreeMesh, body: Body, design_speed_m_s: float, options: BuildOptions, render_glb: bytes
) -> Metadata:
    """Metadata of a table that is known before its motion."""
    return {
        "species": tree.species or "default",
        "foliage": "leaf" if has_leaves(tree, options) else "bare",
        "height_m": tree.height_m,
        "streamlined_exponent": body.streamlined_exponent,
        "dt_s": options.fem.dt_s,
        "design_speed_m_s": design_speed_m_s,
        "mesh_sha256": hashlib.sha256(render_glb).hexdigest(),
        "frequencies_hz": body.frequencies_hz,
        "provenance": {
            "software": _version(),
            "wood": body.wood,
            **body.identity,
            "fem": asdict(options.fem),
            "table_settings": asdict(options.table),
            "seed": options.seed,
            "sampled_elements": options.sampled_elements,
            "target_tets": options.target_tets,
        },
    }


def build_report(
    tree: TreeMesh,
    made: TreeModel,
    wind: DesignWind,
    table: Table,
    records: Records | None,
    reference: dict[str, Any] | None,
) -> dict[str, Any]:
    """JSON-able report of all assumptions and measurements of a build, but its durations."""
    return {
        "import": tree.report,
        "tree": figures_of(tree, made),
        "meshing": made.tets.report,
        "skeleton": made.skeleton.report,
        "foliage": made.lumped.report,
        "model": made.fem.report | ({"reference": reference} if reference else {}),
        "design_wind": asdict(wind),
        "table": {
            **{name: table.metadata[name] for name in ("modes", "errors")},
            "errors_in": ERRORS_IN,
            "nodes": len(table.node_rest_m),
            "joints": len(table.joint_share),
            **(_of_records(records) if records else {}),
        },
        "drawn": _drawn(table),
    }


def _drawn(table: Table) -> dict[str, Any]:
    """The figures of what is drawn, with a warning if the tree would look torn."""
    drawn = table.metadata.get("drawn", {})
    return {**drawn, "warning": f"The table {stretch_words(drawn)}."} if is_torn(drawn) else drawn


def _of_records(records: Records) -> dict[str, Any]:
    candidates = np.diff(records.offsets.astype(np.int64))
    return {
        **{name: records.metadata[name] for name in ("records", "points", "sigma_pa")},
        "candidates": int(candidates.sum()),
        "candidates_most": int(candidates.max()),
    }


def _version() -> str:
    try:
        return f"galewood {metadata.version('galewood')}"
    except metadata.PackageNotFoundError:
        return "galewood"
