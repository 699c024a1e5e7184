"""Strain of a tree in a child process with limits, for services: the mesh may be anybody's."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from galewood.options import ImportRequest
from galewood.sandbox import Arrays, Limits, from_json_array, run_limited, to_bytes_array, to_json_array
from galewood.solid.strain.sections import RodSections, strain_in_wind
from galewood.solid.strain.tree_rods import wind_rods
from galewood.tree import read_tree
from galewood.util import MeshError
from galewood.wood import wood_of_species

LIMITS = Limits(memory_bytes=3 << 30, cpu_s=60)


def strain_limited(
    render_glb: bytes,
    species: str | None,
    wind_m_s: float,
    direction_deg: float,
    *,
    leaves: bool = True,
    wanted: Callable[[], bool] = lambda: True,
) -> bytes:
    """The strain of a tree in a steady wind as JSON, computed in a child process. Raises MeshError.

    ``points_m`` (n, 3) of its axes with the ``parent`` that each grows from, −1 at the root; ``strain`` (n,)
    of the section between both, null where none is computed; and the figures of ``TreeStrain``. Once it is no
    longer ``wanted``, Cancelled is raised.
    """
    asked = {"species": species, "leaves": leaves, "wind_m_s": wind_m_s, "direction_deg": direction_deg}
    arguments = {"mesh": to_bytes_array(render_glb), "asked": to_json_array(asked)}
    target = "galewood.solid.strain.limited:strain_in_child"
    return run_limited(target, arguments, LIMITS, what="The strain", wanted=wanted)["strain"].tobytes()


def strain_in_child(arguments: Arrays) -> Arrays:
    """Entry point of the child process of ``strain_limited``."""
    asked = from_json_array(arguments["asked"])
    species: str | None = asked["species"]
    tree = read_tree(arguments["mesh"].tobytes(), "tree.glb", ImportRequest(species=species))
    wood, hint = wood_of_species(species or "default"), "Correct the pieces of the tree, or its height."
    try:
        rods = wind_rods(tree, wood, leaves=asked["leaves"])
    except ValueError as error:
        title = "No branches were found in the wood of this tree."
        raise MeshError("no-branches", "unsuitable", title, hint) from error
    try:
        found = strain_in_wind(rods, asked["wind_m_s"], asked["direction_deg"])[0]
    except ArithmeticError as error:
        title = "The tree has no equilibrium in this wind."
        raise MeshError("no-equilibrium", "unsuitable", title, "Choose a weaker wind.") from error
    strain = np.full(len(rods.points_m), np.nan)
    strain[RodSections(rods).rod] = found.strain
    document = {
        "points_m": rods.points_m.round(4).tolist(),
        "parent": rods.rods.parent.tolist(),
        "strain": [None if np.isnan(one) else one for one in strain.tolist()],
        **found.figures(),
    }
    return {"strain": to_json_array(document)}
