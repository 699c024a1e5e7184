"""The mesh that the viewer moves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import scipy.sparse

from galewood.model import Axis, Feet
from galewood.pipeline.drawn_figures import DrawnFigures
from galewood.util import Floats


@dataclass(frozen=True)
class RenderMesh:
    """The mesh that the viewer moves: vertices in file order and their weights on the tet vertices."""

    vertices_m: Floats  # (v, 3)
    binding: scipy.sparse.csr_matrix  # (v, n)
    primitives: list[dict[str, Any]]  # name, kind, vertices
    axis: Axis
    feet: Feet
    """The place on the axis that holds each vertex."""
    figures: DrawnFigures | None = None
    """Measures what is drawn; None: nothing is measured."""
