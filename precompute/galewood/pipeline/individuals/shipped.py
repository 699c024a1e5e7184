"""Writes the motion of the built-in trees without dimensions, in one file beside their tables."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

from galewood.options import ImportRequest
from galewood.pipeline.individuals.motions import SpeciesMotion, SpeciesMotions
from galewood.pipeline.individuals.species_motion import species_motion
from galewood.pipeline.results import motions_path, shipped_bare_tables, shipped_tables
from galewood.pipeline.stages import BuiltinMesh, builtin_meshes
from galewood.solid.model import beam_model
from galewood.table import decode
from galewood.threads import single_threaded
from galewood.tree import read_tree
from galewood.util import write_atomically
from galewood.wood import wood_of_species

MOTIONS_VERSION = 2
"""Changes with the meaning of what is written."""
DIGIT_COUNT = 6


def ship_motions(folder: Path) -> bool:
    """Write the motions of the built-in trees of a folder, unless they are up to date; whether it did."""
    meshes, path = builtin_meshes(folder), motions_path(folder)
    tables = {name: table.read_bytes() for name, table in shipped_tables(folder).items()}
    bare = {name: table.read_bytes() for name, table in shipped_bare_tables(folder).items()}
    hashes = [
        (name, hashlib.sha256(table).hexdigest()) for kind in (tables, bare) for name, table in kind.items()
    ]
    key = hashlib.sha256(json.dumps([MOTIONS_VERSION, hashes]).encode()).hexdigest()
    if path.is_file() and json.loads(path.read_bytes())["key"] == key:
        return False
    motions = {
        mesh.name: builtin_motions(mesh, tables[mesh.name], bare.get(mesh.name)).document() for mesh in meshes
    }
    text = json.dumps({"key": key, "motions": motions}, separators=(",", ":")) + "\n"
    write_atomically(path, text.encode())
    return True


@single_threaded
def builtin_motions(mesh: BuiltinMesh, table: bytes, bare_table: bytes | None) -> SpeciesMotions:
    """The motion of a built-in tree, from its mesh, its table in leaf and, if it has one, its bare table."""
    options = ImportRequest(species=str(mesh.options["species"]), height_m=float(mesh.options["height_m"]))
    tree = read_tree(mesh.path.read_bytes(), mesh.path.name, options)
    wood = wood_of_species(tree.species or "default")
    leaf = _rounded(species_motion(decode(table), beam_model(tree, wood)))
    if bare_table is None:
        return SpeciesMotions(leaf)
    return SpeciesMotions(
        leaf, _rounded(species_motion(decode(bare_table), beam_model(tree, wood, leaves=False)))
    )


def _rounded(motion: SpeciesMotion) -> SpeciesMotion:
    def short(value: float) -> float:
        return float(f"{value:.{DIGIT_COUNT}g}")

    return SpeciesMotion(
        tuple(map(short, motion.stiffness)),
        short(motion.sway),
        short(motion.speed),
        short(motion.pressure),
        tuple(map(short, motion.force)),
    )
