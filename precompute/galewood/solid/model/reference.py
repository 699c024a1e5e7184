"""The reference model (quadratic elements) and the error of the fast elements relative to it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from galewood.solid.fem import FemModel, FemSettings
from galewood.solid.model.comparison import compare
from galewood.solid.model.construction import LumpedMassesLike, MeshLike, SkeletonLike, build_model
from galewood.wood import Wood


def compare_with_reference(
    fast: FemModel, mesh: MeshLike, skeleton: SkeletonLike, wood: Wood, lumped: LumpedMassesLike, frames: int
) -> dict[str, Any]:
    """Compare a fast model with the reference: first ten frequencies and a run of `frames` frames."""
    return compare(fast, reference_model(mesh, skeleton, wood, lumped, fast.settings), frames)


def reference_model(
    mesh: MeshLike, skeleton: SkeletonLike, wood: Wood, lumped: LumpedMassesLike, settings: FemSettings
) -> FemModel:
    """The model with quadratic elements and otherwise equal settings."""
    settings = replace(settings, element="quadratic")
    return build_model(mesh, skeleton, wood, lumped, settings)
