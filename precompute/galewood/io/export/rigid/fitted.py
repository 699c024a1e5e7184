"""A tree as a chain of rigid bodies with everything that MuJoCo needs, fitted to the finite elements."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from galewood.io.export.rigid.bodies import RigidTree, rigid_tree
from galewood.io.export.rigid.chain import Masses, gravity, jacobian, mass_matrix, natural_modes
from galewood.io.export.rigid.damping import FITTED_MODES, damping_ratios, hinge_damping
from galewood.io.export.rigid.drag import drawn_areas, exposed_on_bodies, least_masses
from galewood.io.export.rigid.fit import Chain, fitted_stiffness
from galewood.io.export.rigid.masses import body_masses, leaf_areas, lumped, mode_inertia, node_masses
from galewood.io.export.rigid.solid import Solid
from galewood.io.export.rigid.targets import oscillators, sections
from galewood.io.export.skeletal.radii import wood_vertices
from galewood.table import Compliance, Table
from galewood.util import Floats, Ints

CHECKED_MODES = 5


@dataclass(frozen=True)
class FittedTree:
    """b bodies and their 3b hinges; axes of the table (y up)."""

    tree: RigidTree
    masses: Masses
    ground_kg: float
    """Mass of what does not move: with few bodies, the foot of the stem."""
    stiffness: Floats
    """(3b,) N m/rad"""
    damping: Floats
    """(3b,) N m s/rad"""
    reference_rad: Floats
    """(3b,) angle at which each spring is free: at rest, the springs carry the weight."""
    area_m2: Floats
    """(b,) exposed to the wind, drag coefficient and wind profile included."""
    area_centre_m: Floats
    """(b, 3)"""
    measured: dict[str, Any]
    """Errors of the linear model, %."""


def fitted_tree(
    table: Table, compliance: Compliance, rest_m: Floats, faces: Sequence[Ints], most: int
) -> FittedTree:
    """At most ``most`` bodies for the tree of a table; ``rest_m`` (v, 3) and ``faces``: its drawn mesh."""
    solid, own = Solid(compliance), oscillators(table, rest_m)
    tree = rigid_tree(table, rest_m, most)
    bound = wood_vertices(table)
    shape = solid.spread(bound, own.shape[bound].reshape(len(bound), -1)).reshape(-1, 3, len(own.omega))
    node_kg = node_masses(table, solid, shape, leaf_areas(table, rest_m, faces))
    nodes = lumped(tree, table, solid, rest_m, node_kg)
    masses = body_masses(tree, table, nodes)
    wood = sections(table, solid, rest_m, own, tree)
    torque, weight = gravity(tree, masses)
    chain = Chain(
        tree,
        mass_matrix(tree, masses),
        weight,
        jacobian(tree, tree.of_node[wood.node], wood.place_m),
        wood.yields,
        mode_inertia(tree, nodes, shape),
        wood.shape / np.square(own.omega),
        np.array(table.metadata["frequencies_hz"], np.float64),
    )
    hinges = fitted_stiffness(chain)
    stiffness = chain.stiffness(hinges)
    pulls = chain.rows.reshape(-1, len(hinges))
    bent = np.linalg.solve(stiffness, pulls.T)
    modes = natural_modes(chain.mass, stiffness, FITTED_MODES)
    alpha, beta = own.rayleigh()
    dampers = hinge_damping(modes, hinges, alpha, beta)
    drawn_m2, centre = drawn_areas(tree, table, rest_m, faces)
    # displacement of the sections by forces along x and z on the bodies
    moves = jacobian(tree, np.arange(tree.count), centre)
    pushed = np.einsum("bih,hs->isb", moves[:, [0, 2]], bent)
    swayed = np.einsum("gik,kj->jgi", chain.swayed, table.modal_load.astype(np.float64))
    area = exposed_on_bodies(
        drawn_m2,
        pushed.reshape(-1, tree.count),
        swayed.ravel(),
        table,
        least_masses(chain.mass, dampers, moves),
    )
    omega = 2 * np.pi * modes.frequency_hz
    ratio = damping_ratios(modes, dampers) / (0.5 * (alpha / omega + beta * omega))
    given = chain.frequency_hz[:CHECKED_MODES]
    yields = np.einsum("gih,hgj->gij", chain.rows, bent.reshape(len(hinges), -1, 3))
    off = np.linalg.norm(yields - chain.yields, axis=(1, 2)) / np.linalg.norm(chain.yields, axis=(1, 2))
    measured = {
        "frequency_error_percent": (100 * (modes.frequency_hz[: len(given)] / given - 1)).tolist(),
        "damping_error_percent": (100 * (ratio[:CHECKED_MODES] - 1)).tolist(),
        "deflection_error_percent": {
            "median": 100 * float(np.median(off)),
            "90th_percentile": 100 * float(np.quantile(off, 0.9)),
        },
    }
    ground_kg = max(float(node_kg.sum() - masses.mass_kg.sum()), 0.0)
    return FittedTree(tree, masses, ground_kg, hinges, dampers, -torque / hinges, area, centre, measured)
