"""The wind: areas of the bodies for MuJoCo's ellipsoid model of fluid forces, and its wind for a speed.

The table's air moves among the leaves at the sheltered speed U_c and exerts a p(U_c − v) on the exposed area
a; p is quadratic in weak wind, and so is MuJoCo's drag. So the bodies have the exposed areas, and the option
``wind`` is the sheltered speed.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.optimize

from galewood.constants import HALF_AIR_DENSITY_KG_M3
from galewood.io.export.rigid.bodies import GROUND_BODY, RigidTree
from galewood.io.export.rigid.masses import vertex_areas
from galewood.motion.wind import dynamic_pressure
from galewood.table import Table
from galewood.util import Floats, Ints

AIR_KG_M3 = 2 * HALF_AIR_DENSITY_KG_M3
SPHERE_M = 0.02
"""Radius of the spheres that carry the drag: small, so that the air that they displace has no weight."""
AREA_WEIGHT = 0.01
STEP_S = 2e-3
"""Of the exported model."""
MOST_M2_KG = 5.0
"""Of area over the mass that a force on it meets: drag is explicit in MuJoCo's Euler steps, and stable while
ρ v a dt / m is below 2."""
WOOD_SHARE = 0.25
"""Projected area over the surface of a convex body, mean over all directions (Cauchy)."""
SPEEDS_M_S = (2, 4, 6, 8, 10, 12, 15, 20)


def drawn_areas(
    tree: RigidTree, table: Table, rest_m: Floats, faces: Sequence[Ints]
) -> tuple[Floats, Floats]:
    """Area (b,), m², of what is drawn on the bodies, seen from the mean direction, and its centre (b, 3)."""
    drawn, start = np.zeros(len(rest_m)), 0
    for primitive, corners in zip(table.metadata["primitives"], faces, strict=True):
        hidden = table.foliage == "bare" and primitive["kind"] == "leaves"
        share = 0.0 if hidden else 1.0 if primitive["kind"] == "leaves" else WOOD_SHARE
        drawn += share * vertex_areas(rest_m, corners + start)
        start += int(primitive["vertices"])
    body = tree.of_node[table.vertex_node.astype(np.int64)]
    held = body != GROUND_BODY
    area = np.bincount(body[held], drawn[held], tree.count).astype(np.float64)
    weighted = np.stack(
        [np.bincount(body[held], (drawn * rest_m[:, axis])[held], tree.count) for axis in range(3)], axis=1
    )
    rest_of = table.node_rest_m[tree.node].astype(np.float64)
    return area, np.where((area > 0)[:, None], weighted / np.maximum(area, 1e-12)[:, None], rest_of)


def exposed_on_bodies(drawn_m2: Floats, per_area: Floats, swayed: Floats, table: Table, kg: Floats) -> Floats:
    """(b,) m²: exposed areas, with drag coefficient and wind profile; at most MOST_M2_KG for every kg.

    In proportion to what is drawn, and so that a steady wind bends the wood as far as the table says.
    ``per_area`` (m, b): displacements per m² of each body in air whose pressure is 1 Pa among the leaves;
    ``swayed`` (m,): those of the table at a pressure of 1 Pa of the wind.
    """
    total, sheltered = exposed_areas(table)
    first = np.maximum(drawn_m2, 1e-3 * drawn_m2.mean())
    first *= total / float(first.sum())
    most = np.maximum(MOST_M2_KG * kg / first, 1e-9)
    scale = 1.0 / float(np.linalg.norm(swayed))
    rows = np.concatenate([per_area * first * (scale * sheltered / total), AREA_WEIGHT * np.eye(len(first))])
    right = np.concatenate([swayed * scale, AREA_WEIGHT * np.minimum(1.0, most)])
    return first * scipy.optimize.lsq_linear(rows, right, bounds=(0.0, most)).x


def least_masses(mass: Floats, dampers: Floats, moves: Floats) -> Floats:
    """(b,) kg: mass that a force at a place of each body meets in one step, the least of all directions.

    ``mass`` (h, h) of the chain, ``dampers`` (h,) of its hinges, which a step takes into account implicitly,
    and ``moves`` (b, 3, h): motion of the places per radian.
    """
    stepped = mass + STEP_S * np.diag(dampers)
    rows = moves.reshape(-1, len(mass))
    mobility = np.einsum("bih,hbj->bij", moves, np.linalg.solve(stepped, rows.T).reshape(-1, len(moves), 3))
    return 1.0 / np.maximum(np.linalg.eigvalsh(0.5 * (mobility + mobility.transpose(0, 2, 1)))[:, -1], 1e-9)


def exposed_areas(table: Table) -> tuple[float, float]:
    """Area of the tree in the air among its leaves, and the part of it that a steady wind acts on, m²."""
    area, share = table.modal_drag_point.astype(np.float64).T
    return float(area.sum()), float(area @ share)


def sheltered_speed(table: Table, speed_m_s: float) -> float:
    """MuJoCo's wind, m/s, whose drag on the exposed area is that of a wind of this speed at the top."""
    total, sheltered = exposed_areas(table)
    pressure = float(dynamic_pressure(speed_m_s, table.streamlined_exponent)) * sheltered / total
    return float(np.sqrt(pressure / HALF_AIR_DENSITY_KG_M3))


def drag_coefficients(area_m2: Floats) -> Floats:
    """(b,) blunt coefficients: MuJoCo's drag on a sphere is ρ |v| v π r² C, without a half."""
    return 0.5 * area_m2 / (np.pi * SPHERE_M**2)
