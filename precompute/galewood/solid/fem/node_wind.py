"""A wind at the nodes of a model: its pressure at the tree, and the gusts that differ within the crown.

The finite elements take these pressures (``Simulator.step``), so that a reference solution is in the same
wind as the trees of a forest (``galewood.player.WindDrivenTrees``).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from galewood.motion.wind import (
    TreePressure,
    WindField,
    WindState,
    crown_carried,
    crown_field,
    gust_pressures,
    to_tree_frame,
    write_gusts,
)
from galewood.solid.fem.model import FemModel
from galewood.util import Floats


@dataclass(frozen=True)
class Place:
    """Position and yaw of a tree, and the time of the wind's clock at which it is at rest."""

    x_m: float = 0.0
    z_m: float = 0.0
    yaw_rad: float = 0.0
    start_s: float = 0.0


class NodePressure(NamedTuple):
    """Pressures along x and z of the tree's own frame, Pa, in one time step."""

    tree_pa: Floats  # (2,) at the tree
    node_pa: Floats  # (N, 2) at each node
    ratio: float
    """Pressure at the tree before it was compressed, over the strongest one of the table."""


def node_pressures(
    model: FemModel, wind: WindState, place: Place, frames: int, *, height_m: float, most_pa: float
) -> Iterator[NodePressure]:
    """The wind of each time step at the nodes, the first of which ends one step after ``place.start_s``.

    ``height_m`` is the height of the tree in the wind profile. Winds stronger than ``most_pa``, Pa, are
    compressed as those of a forest are; ``numpy.inf`` leaves them as they are.
    """
    steps = place.start_s + model.settings.dt_s * np.arange(1, frames + 1, dtype=np.float64)
    return point_pressures(
        model.nodes_m, model.streamlined_exponent, wind, place, steps, height_m=height_m, most_pa=most_pa
    )


def point_pressures(
    rest_m: Floats,
    exponent: float,
    wind: WindState,
    place: Place,
    time_s: Floats,
    *,
    height_m: float,
    most_pa: float = np.inf,
) -> Iterator[NodePressure]:
    """The wind at times (T,) of its clock at points (N, 3) of a tree with a streamlined exponent."""
    field = WindField(wind)
    x_m, z_m, size = np.array([place.x_m]), np.array([place.z_m]), np.ones(1)
    pressure = TreePressure(x_m, z_m, [height_m], most_pa, exponent, limited=False)
    rest_m = np.ascontiguousarray(rest_m)
    turn = np.array([[np.cos(place.yaw_rad), np.sin(place.yaw_rad)]])
    gusts = np.zeros((1, 2 * len(rest_m)))
    for now_s in time_s.tolist():
        pressure.advance(field, now_s)
        world, moment = (pressure.x_pa, pressure.z_pa), field.at(now_s)
        field_of_crown, carried = crown_field(moment.crown.seed), crown_carried(moment)
        write_gusts(field_of_crown, carried, rest_m, (x_m, z_m), turn, size, world, exponent, gusts)
        x_pa, z_pa = to_tree_frame(*world, place.yaw_rad)
        tree_pa = np.array([x_pa[0], z_pa[0]])
        node_pa = tree_pa + gust_pressures(gusts, x_pa, z_pa)[0].T
        yield NodePressure(tree_pa, node_pa, float(pressure.ratio[0]))
