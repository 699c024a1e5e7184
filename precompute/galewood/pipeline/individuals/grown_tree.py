"""An individual from its document to its files: grown, read as an import reads it, and with its motion."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from galewood.growth import grow_files
from galewood.options import ImportRequest
from galewood.pipeline.individuals.document import IndividualDocument
from galewood.pipeline.individuals.quick_table import individual_table
from galewood.pipeline.results import BuildResult
from galewood.pipeline.tables import BuildOptions
from galewood.table import Foliage, encode
from galewood.threads import single_threaded
from galewood.tree import TreeMesh, read_tree, render_glb

OnStage = Callable[[float, str], None]
"""Receives the share that is done, and what is done next; raises Cancelled if that is not wanted."""


@dataclass(frozen=True)
class GrownMesh:
    """The mesh of an individual as an import reads it, and the one that its table moves."""

    tree: TreeMesh
    render_glb: bytes = field(repr=False)


def read_grown(document: IndividualDocument, glb: bytes) -> GrownMesh:
    """Read the mesh of an individual. Where the nearest size was taken, its height is that of the mesh."""
    request = document.request
    height_m = None if request.nearest_size else request.height_m
    options = ImportRequest(species=document.species, height_m=height_m)
    tree = read_tree(glb, f"{document.name}.glb", options)
    return GrownMesh(tree, render_glb(tree))


@single_threaded
def quick_motion(
    document: IndividualDocument, grown: GrownMesh, foliage: Foliage = "leaf"
) -> tuple[bytes, dict[str, Any]]:
    """The table of an individual, encoded, and its report; within seconds.

    Raises ValueError for the bare table of a species that keeps its leaves.
    """
    motion = document.motions.bare if foliage == "bare" else document.motions.leaf
    if motion is None:
        raise ValueError(f"A tree of the species {document.species} keeps its leaves: it has no bare table")
    options = BuildOptions(
        species=document.species, height_m=grown.tree.height_m, stiffness="as drawn", foliage=foliage
    )
    table = individual_table(grown.tree, motion, options, grown.render_glb)
    report = {"individual": json.loads(document.encoded()), "drawn": table.metadata.get("drawn", {})}
    return encode(table), report


def individual_result(
    document: IndividualDocument,
    on_stage: OnStage = lambda share, message: None,
    wanted: Callable[[], bool] = lambda: True,
) -> BuildResult:
    """Grow an individual and make its tables. Raises GrowthError, Cancelled, and what ``on_stage`` raises."""
    on_stage(0.05, "Growing the tree")
    files = grow_files(document.species, document.request, wanted=wanted)
    on_stage(0.35, "Reading its mesh")
    grown = read_grown(document, files.glb)
    on_stage(0.5, "Making its table")
    table, report = quick_motion(document, grown)
    report |= grown.tree.report
    if document.motions.bare is None:
        return BuildResult(table, None, grown.render_glb, report)
    on_stage(0.8, "Making its table without leaves")
    bare_table, bare_report = quick_motion(document, grown, "bare")
    report["bare_table"] = {"drawn": bare_report["drawn"]}
    return BuildResult(table, None, grown.render_glb, report, bare_table)
