"""The reference beside a build: the same tree of quadratic elements, and how far off the fast ones are."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from precompute.comparison import compare
from precompute.helpers import Helpers
from precompute.model import FemModel, FemSettings
from precompute.modelling import LumpsLike, MeshLike, SkeletonLike, build_model
from precompute.wood import Wood


def compare_with_reference(
    fast: FemModel, mesh: MeshLike, skeleton: SkeletonLike, wood: Wood, lumps: LumpsLike, frames: int
) -> dict[str, Any]:
    """The first ten frequencies and a run of this many frames of a fast model against the reference's."""
    return compare(fast, reference_model(mesh, skeleton, wood, lumps, fast.settings), frames)


def reference_model(
    mesh: MeshLike, skeleton: SkeletonLike, wood: Wood, lumps: LumpsLike, settings: FemSettings
) -> FemModel:
    """The tree of quadratic elements, all other settings alike."""
    settings = replace(settings, element="quadratic", reference_frames=0)
    return build_model(mesh, skeleton, wood, lumps, settings)


def start_comparison(
    helpers: Helpers,
    fast: FemModel,
    mesh: MeshLike,
    skeleton: SkeletonLike,
    wood: Wood,
    lumps: LumpsLike,
    settings: FemSettings,
) -> Callable[[], dict[str, Any] | None]:
    """Begin the comparison beside the build; the function returned waits for its figures (None: unasked)."""
    if settings.element != "fitted" or not settings.reference_frames:
        return lambda: None
    frames = settings.reference_frames
    return helpers.start(compare_with_reference, fast, mesh, skeleton, wood, lumps, frames).result
