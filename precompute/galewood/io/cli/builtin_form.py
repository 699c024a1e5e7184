"""How a built-in tree bends in wind, for the reports of stands (`galewood ship`)."""

from __future__ import annotations

from galewood.check.field import diameter_cm
from galewood.check.stand import TreeForm, form_of_rods
from galewood.constants import BREAST_HEIGHT_M
from galewood.io.api import read
from galewood.pipeline.stages import BuiltinMesh
from galewood.solid.model import beam_model
from galewood.solid.strain import wind_rods
from galewood.table import Foliage
from galewood.wood import wood_of_species


def builtin_form(mesh: BuiltinMesh, foliage: Foliage) -> TreeForm:
    """A built-in tree, bent in winds of all speeds; evergreens have their leaves in every season."""
    tree = read(mesh.path, species=str(mesh.options["species"]), accept=True)
    wood = wood_of_species(tree.species or "default")
    leaves = foliage == "leaf" or wood.evergreen
    dbh_cm = diameter_cm(tree.wood_vertices_m, tree.wood_faces, BREAST_HEIGHT_M)
    if dbh_cm is None:
        raise ValueError(f"{mesh.name} is lower than 1.3 m")
    frequency_hz = float(beam_model(tree.mesh, wood, leaves=leaves).frequencies_hz.min())
    return form_of_rods(mesh.name, wind_rods(tree.mesh, wood, leaves=leaves), dbh_cm / 100, frequency_hz)
