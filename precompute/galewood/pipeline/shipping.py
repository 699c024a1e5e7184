"""Builds the tables that are distributed with the software (galewood.shipped describes the files)."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from galewood.options import BuildRequest
from galewood.pipeline.build import build_table, compliance_of_source
from galewood.pipeline.options import Progress, build_options
from galewood.shipped import PICTURE, SHIPPED_FOLDER, ShippedTree, build_key, read_shipped, write_shipped
from galewood.util import write_whole

TETS = "tets-"


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
        build_options(BuildRequest.model_validate({"bare_table": True, **mesh.options})),
        progress=progress,
        cache_dir=cache_dir,
        publish=published.__setitem__,
    )
    assert result.records is not None
    tets_name = next(name for name in published if name.startswith(TETS))
    tree = ShippedTree(
        table=result.table,
        records=result.records,
        render_glb=result.render_glb,
        tets=published[tets_name],
        tets_name=tets_name,
        report=result.report,
        pictures={name: content for name, content in published.items() if name.endswith(PICTURE)},
        bare_table=result.bare_table,
        compliance=result.compliance,
    )
    write_shipped(folder, mesh.name, mesh.key, tree)
    return tree


def ship_compliance(mesh: BuiltinMesh, folder: Path, cache_dir: Path) -> int | None:
    """Compute the compliance file of a shipped tree from its tetrahedra and add it to ``folder``.

    Nothing is simulated. Returns the size of the file in bytes; None: the tree is not shipped, or has none.
    """
    shipped = read_shipped(folder, mesh.name, mesh.key)
    if shipped is None:
        return None
    tets = cache_dir / "tets" / shipped.tets_name
    if not tets.exists():
        write_whole(tets, shipped.tets)
    options = build_options(BuildRequest.model_validate(mesh.options))
    compliance = compliance_of_source(mesh.path.read_bytes(), mesh.path.name, options, cache_dir)
    write_shipped(folder, mesh.name, mesh.key, replace(shipped, compliance=compliance))
    return None if compliance is None else len(compliance)


def outdated(folder: Path) -> Iterator[BuiltinMesh]:
    """The built-in trees of a folder whose shipped files are missing, damaged, or built from other inputs."""
    for mesh in builtin_meshes(folder):
        if read_shipped(folder / SHIPPED_FOLDER, mesh.name, mesh.key) is None:
            yield mesh
