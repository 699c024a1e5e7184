"""Motion of one tree under one wind: the reference solution and both methods of its table.

The comparison of the web page shows it. The wind is that of the page: its gusts differ within the crown, and
the reference solution feels them at each of its nodes. The errors in the same wind without these gusts, the
same over the whole crown, are computed too. All tracks are modal coordinates q of the table, so that one
renderer draws them: the displacement of the nodes is basis (n, 3, r) times q (r).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse

from galewood.check.evaluation.evaluate import OnProgress, methods_of, play_pressures
from galewood.check.evaluation.gusts import play_in_wind, strongest_pa
from galewood.check.evaluation.measures import hausdorff
from galewood.check.evaluation.model_file import tets_of
from galewood.check.evaluation.report import share
from galewood.motion.wind import WindState, limit_pressure
from galewood.options import METHOD_NAMES, Method
from galewood.solid.fem import FemModel, NodePressure, Place, Simulator, node_pressures
from galewood.solid.skinning import points_embedding
from galewood.table import Table
from galewood.util import Floats


@dataclass(frozen=True)
class Errors:
    """Per frame, over the tree's height: largest node error, and Hausdorff distance of the nodes."""

    max: Floats  # (frames,)
    hausdorff: Floats  # (frames,)


@dataclass(frozen=True)
class Uniform:
    """Sway and errors in the same wind without the gusts that differ within the crown."""

    sway: Floats  # (frames,)
    errors: dict[str, Errors]


@dataclass(frozen=True)
class Comparison:
    """Coordinates of all motions, pressure at the tree, and errors; "paper" only with its records."""

    pressure_pa: Floats  # (frames, 2) in the tree's own frame
    q: dict[str, Floats]  # fem, modal, paper: (frames, r)
    sway: Floats  # (frames,) largest node displacement of the reference solution, over the height
    errors: dict[str, Errors]  # modal, paper
    left_out: Floats  # (frames,) largest part of the reference outside the basis, over the height
    uniform: Uniform


def nodes_on_wood(table: Table, model: FemModel) -> scipy.sparse.csr_matrix:
    """(n, N) weights of the table's nodes on the vertices of the model."""
    return points_embedding(table.node_rest_m, tets_of(model))


def comparison_tracks(
    table: Table,
    model: FemModel,
    nodes: scipy.sparse.csr_matrix,
    wind: WindState,
    place: Place,
    frames: int,
    on_progress: OnProgress,
) -> Comparison:
    """Compute the motions of a tree at a place in a wind; ``nodes`` comes from ``nodes_on_wood``.

    ``on_progress`` gets the fraction 0..1 and a message; it may raise to cancel. Raises FloatingPointError if
    the reference simulation diverges.
    """
    pressures = pressures_at(table, model, wind, place, frames)
    pressure_pa = np.array([pressure.tree_pa for pressure in pressures])
    compare = _Comparing(table, model, nodes)
    in_gusts = [pressure.node_pa for pressure in pressures]
    reference = compare.simulate(in_gusts, share(on_progress, 0.0, 0.4))
    methods: list[Method] = [name for name in METHOD_NAMES if name in methods_of(table)]
    q = {name: play_in_wind(table, wind, place, frames, name)[0] for name in methods}
    errors = {name: compare.errors(q[name], reference) for name in methods}
    basis = compare.basis
    projected = np.asarray(
        np.linalg.lstsq(basis, reference.reshape(frames, -1).T, rcond=None)[0].T, np.float64
    )
    sway = compare.farthest(reference)
    left_out = compare.farthest(compare.moved(projected) - reference)
    if all((pressure.node_pa == pressure.tree_pa).all() for pressure in pressures):
        uniform = Uniform(sway, errors)
    else:
        uniform = compare.in_uniform_wind(pressure_pa, methods, share(on_progress, 0.4, 0.95))
    on_progress(1.0, "Done")
    return Comparison(pressure_pa, {"fem": projected, **q}, sway, errors, left_out, uniform)


def pressures_at(
    table: Table, model: FemModel, wind: WindState, place: Place, frames: int
) -> list[NodePressure]:
    """The wind of every frame, as in a forest: frame i is at start + (i + 1) steps.

    The tree's height enters the wind profile, and winds beyond the range of the table are compressed.
    """
    height_m, most_pa = float(table.metadata["height_m"]), strongest_pa(table)
    return list(node_pressures(model, wind, place, frames, height_m=height_m, most_pa=most_pa))


class _Comparing:
    """Compares motions of a table's nodes, whose weights on its model are ``nodes`` (n, N)."""

    def __init__(self, table: Table, model: FemModel, nodes: scipy.sparse.csr_matrix) -> None:
        self._table, self._model, self._nodes = table, model, nodes
        self._rest_m, self._height_m = table.node_rest_m.astype(np.float64), float(table.metadata["height_m"])
        self.basis = table.node_basis.astype(np.float64).reshape(-1, len(table.mode_scale))
        """(3n, r) displacement of the nodes per unit of q."""

    def simulate(self, pressure_pa: Sequence[Floats], on_progress: OnProgress) -> Floats:
        """(frames, n, 3) displacement of the nodes, m, under pressures (2,) or (N, 2), Pa."""
        simulator, frames = Simulator(self._model), len(pressure_pa)
        vertices = self._model.vertex_count
        at_rest = self._nodes @ simulator.u[:vertices]
        track = np.empty((frames, len(at_rest), 3))
        for frame, pressure in enumerate(pressure_pa):
            on_progress(frame / frames, "Simulating")
            simulator.step(pressure)
            track[frame] = self._nodes @ simulator.u[:vertices]
        return track

    def in_uniform_wind(
        self, pressure_pa: Floats, methods: Sequence[str], on_progress: OnProgress
    ) -> Uniform:
        """Sway and errors under one pressure (frames, 2), Pa, for the whole crown."""
        reference = self.simulate(list(pressure_pa), on_progress)
        makes = methods_of(self._table)
        found: dict[str, Errors] = {}
        for name in methods:
            x_pa, z_pa = pressure_pa.T.copy()
            if name == "paper":  # as in a forest (WindDrivenTrees)
                limit_pressure(x_pa, z_pa, self._table.peak_pressure_pa)
            q, _ = play_pressures(self._table, np.stack([x_pa, z_pa], axis=1), makes[name])
            found[name] = self.errors(q, reference)
        return Uniform(self.farthest(reference), found)

    def moved(self, q: Floats) -> Floats:
        """(frames, n, 3) displacement of the nodes, m."""
        return (q @ self.basis.T).reshape(len(q), -1, 3)

    def errors(self, q: Floats, reference: Floats) -> Errors:
        """Errors of coordinates q (frames, r)."""
        track, rest_m = self.moved(q), self._rest_m
        distances = [
            hausdorff(rest_m + one, rest_m + other) for one, other in zip(track, reference, strict=True)
        ]
        return Errors(self.farthest(track - reference), np.array(distances) / self._height_m)

    def farthest(self, displacement_m: Floats) -> Floats:
        """(frames,) length of the longest of the vectors (frames, n, 3), over the height."""
        longest: Floats = np.linalg.norm(displacement_m, axis=2).max(axis=1) / self._height_m
        return longest
