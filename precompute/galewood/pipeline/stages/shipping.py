"""Builds the tables that are distributed with the software (`pipeline.results.shipped`: their files)."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from galewood.pipeline.results import (
    BUILTIN_OPTIONS,
    DRAWN_SPRAYS_NAME,
    LIGHT_FOLDER,
    PICTURE_SUFFIX,
    SHIPPED_FOLDER,
    SHOOTS_NAME,
    SPRAYS_NAME,
    ShippedTree,
    build_key,
    read_shipped,
    write_light,
    write_shipped,
)
from galewood.pipeline.stages.artefacts import TETS_PREFIX
from galewood.pipeline.stages.build import build_table
from galewood.pipeline.stages.stage import Progress
from galewood.pipeline.tables import BuildOptions
from galewood.util import write_atomically


@dataclass(frozen=True)
class BuiltinMesh:
    """The mesh of a built-in tree and the options of its build."""

    name: str
    path: Path
    options: dict[str, Any]

    @property
    def key(self) -> str:
        """Hash of what its shipped files must have been built from."""
        return build_key(self.path.read_bytes(), self.options)


def builtin_meshes(folder: Path) -> list[BuiltinMesh]:
    """The built-in trees of a folder with a species.json. Raises OSError, ValueError."""
    entries = json.loads((folder / "species.json").read_bytes())
    return [
        BuiltinMesh(
            str(entry["id"]),
            folder / str(entry["file"]),
            {"species": entry["species"], "height_m": entry["height_m"]},
        )
        for entry in entries
    ]


def ship(
    mesh: BuiltinMesh, folder: Path, cache_dir: Path, progress: Callable[[Progress], None] = lambda p: None
) -> ShippedTree:
    """Build the files of a built-in tree and write them to ``folder``."""
    published: dict[str, bytes] = {}
    result = build_table(
        mesh.path.read_bytes(),
        mesh.path.name,
        BuildOptions.model_validate({**BUILTIN_OPTIONS, **mesh.options}),
        progress=progress,
        cache_dir=cache_dir,
        publish=published.__setitem__,
    )
    tets_name = next(name for name in published if name.startswith(TETS_PREFIX))
    pictures = {name: content for name, content in published.items() if name.endswith(PICTURE_SUFFIX)}
    tree = ShippedTree(result, published[tets_name], tets_name, pictures)
    write_shipped(folder, mesh.name, mesh.key, tree)
    return tree


def unpacked(mesh: BuiltinMesh, folder: Path, cache_dir: Path) -> Path:
    """The table file of a shipped tree with its records, written to ``cache_dir`` with its tetrahedra.

    ``folder`` has the meshes of the built-in trees. Raises FileNotFoundError if nothing is shipped for it.
    """
    shipped = read_shipped(folder / SHIPPED_FOLDER, mesh.name, mesh.key)
    if shipped is None:
        raise FileNotFoundError(f"no shipped files for {mesh.name} and this version: run `galewood ship`")
    shipped.keep_tetrahedra(cache_dir)
    path = cache_dir / SHIPPED_FOLDER / f"{mesh.name}.gwt"
    write_atomically(path, shipped.result.whole_table())
    return path


def outdated(folder: Path) -> Iterator[BuiltinMesh]:
    """The built-in trees of a folder whose shipped files are missing, damaged, or built from other inputs."""
    for mesh in builtin_meshes(folder):
        if read_shipped(folder / SHIPPED_FOLDER, mesh.name, mesh.key) is None:
            yield mesh


def ship_light(folder: Path) -> bool:
    """Write the light copies of the shipped render meshes; returns whether any changed.

    Raises FileNotFoundError if a tree is not shipped.
    """
    meshes = builtin_meshes(folder)
    render_glbs = [(folder / SHIPPED_FOLDER / f"{mesh.name}.glb").read_bytes() for mesh in meshes]
    species = [str(mesh.options["species"]) for mesh in meshes]
    endings = {SPRAYS_NAME: "sprays.png", DRAWN_SPRAYS_NAME: "sprays.json", SHOOTS_NAME: "shoots.png"}
    files = {(one, name): folder / f"{one}.{end}" for one in species for name, end in endings.items()}
    drawn = {kind: path.read_bytes() for kind, path in files.items() if path.is_file()}
    trees = zip([mesh.name for mesh in meshes], species, render_glbs, strict=True)
    return write_light(folder / LIGHT_FOLDER, trees, drawn)
