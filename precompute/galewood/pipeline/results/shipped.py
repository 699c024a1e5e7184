"""Tables that are distributed with the software, beside the meshes of the built-in trees.

A folder holds for each tree ``name``: ``name.json`` (what it was built from, the report of the build, the
hashes of the files), ``name.table``, ``name.bare.table`` (of the tree without its leaves; it may be missing),
``name.records.gz`` (of ``name.table``), ``name.compliance.gz`` (for pulling the tree; it may be missing),
``name.glb`` (the render mesh), ``name.tets.npz`` (the tetrahedra, because the mesher is not repeatable) and
pictures, ``name.*.png``; and for all trees together ``forms.json``, their bending in wind
(`galewood.check.stand`), and ``motions.json``, what individuals take over (`galewood.pipeline.individuals`).
"""

from __future__ import annotations

import gzip
import hashlib
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from galewood.constants import TABLE_VERSION
from galewood.pipeline.results.result import BuildResult
from galewood.table import read_metadata
from galewood.util import write_atomically
from galewood.versions import SAMPLING_VERSION

SHIPPED_FOLDER = "shipped"
"""Folder of the shipped files, beside the meshes of the built-in trees."""
BUILTIN_OPTIONS: dict[str, Any] = {"bare_table": True, "stiffness": "as drawn"}
"""Options of the build of a built-in tree besides its own: they are real trees, and have two tables."""
PICTURE_SUFFIX = ".png"
SHIPPED_SUFFIXES = {
    "table": ".table",
    "bare_table": ".bare.table",
    "records": ".records.gz",
    "compliance": ".compliance.gz",
    "render_glb": ".glb",
}
"""File of a result -> how its name ends, after that of the tree."""
FORMS_FILE, MOTIONS_FILE = "forms.json", "motions.json"
TETS_SUFFIX, PACKED_SUFFIX = ".tets.npz", ".gz"


def shipped_tables(species_dir: Path) -> dict[str, Path]:
    """The tables in leaf by the names of their trees, in this folder of the built-in trees."""
    files = (species_dir / SHIPPED_FOLDER).glob(f"*{SHIPPED_SUFFIXES['table']}")
    return dict(sorted((path.stem, path) for path in files if "." not in path.stem))


def shipped_bare_tables(species_dir: Path) -> dict[str, Path]:
    """The tables without leaves by the names of their trees, in this folder; some trees have none."""
    suffix = SHIPPED_SUFFIXES["bare_table"]
    files = (species_dir / SHIPPED_FOLDER).glob(f"*{suffix}")
    return dict(sorted((path.name.removesuffix(suffix), path) for path in files))


def forms_path(species_dir: Path) -> Path:
    """Where the bending of the trees of a folder is."""
    return species_dir / SHIPPED_FOLDER / FORMS_FILE


def motions_path(species_dir: Path) -> Path:
    """Where the motion of the trees of a folder without dimensions is."""
    return species_dir / SHIPPED_FOLDER / MOTIONS_FILE


@dataclass(frozen=True)
class ShippedTree:
    """The result of a build, as it is distributed."""

    result: BuildResult
    tets: bytes
    """The file of the tetrahedra in the mesher's cache."""
    tets_name: str
    """Its name in the folder ``tets`` of a cache."""
    pictures: dict[str, bytes] = field(default_factory=dict[str, bytes])

    def keep_tetrahedra(self, cache_dir: Path) -> None:
        """Write the tetrahedra to where a build with this cache finds them."""
        path = cache_dir / "tets" / self.tets_name
        if not path.exists():
            write_atomically(path, self.tets)


def build_key(source: bytes, options: dict[str, Any]) -> str:
    """Hash of everything that a shipped tree was built from: mesh, options and versions of the formats."""
    source_sha256 = hashlib.sha256(source).hexdigest()
    # 14 and 14.0 are the same height
    plain = {name: int(v) if isinstance(v, float) and v.is_integer() else v for name, v in options.items()}
    parts = json.dumps([source_sha256, plain, TABLE_VERSION, SAMPLING_VERSION], sort_keys=True)
    return hashlib.sha256(parts.encode()).hexdigest()


def write_shipped(folder: Path, name: str, key: str, tree: ShippedTree) -> None:
    """Write the files of a tree; the index is written last."""
    folder.mkdir(parents=True, exist_ok=True)
    contents = _contents(name, tree)
    for file, content in contents.items():
        write_atomically(folder / file, content)
    index = {
        "key": key,
        "software": read_metadata(tree.result.table)["provenance"].get("software"),
        "tets_name": tree.tets_name,
        "files": {file: hashlib.sha256(content).hexdigest() for file, content in contents.items()},
        "report": tree.result.report,
    }
    write_atomically(folder / f"{name}.json", (json.dumps(index, indent=1) + "\n").encode())


def read_shipped(folder: Path, name: str, key: str) -> ShippedTree | None:
    """The shipped files of a tree, or None if there are none, or none of this key, or one is damaged."""
    try:
        index = json.loads((folder / f"{name}.json").read_bytes())
        if index["key"] != key:
            return None
        files = {file: (folder / file).read_bytes() for file in index["files"]}
        if any(hashlib.sha256(files[file]).hexdigest() != sha for file, sha in index["files"].items()):
            return None
        found = {
            kind: _unpacked(suffix, files[name + suffix])
            for kind, suffix in SHIPPED_SUFFIXES.items()
            if name + suffix in files
        }
        return ShippedTree(
            result=BuildResult(
                table=found["table"],
                records=found["records"],
                render_glb=found["render_glb"],
                report=dict(index["report"]),
                bare_table=found.get("bare_table"),
                compliance=found.get("compliance"),
            ),
            tets=files[name + TETS_SUFFIX],
            tets_name=str(index["tets_name"]),
            pictures={
                file.removeprefix(f"{name}."): files[file] for file in files if file.endswith(PICTURE_SUFFIX)
            },
        )
    except (OSError, ValueError, KeyError, EOFError):
        return None


def _contents(name: str, tree: ShippedTree) -> dict[str, bytes]:
    made = {suffix: getattr(tree.result, kind) for kind, suffix in SHIPPED_SUFFIXES.items()}
    return {
        **{name + suffix: _packed(suffix, content) for suffix, content in made.items() if content},
        name + TETS_SUFFIX: tree.tets,
        **{f"{name}.{picture}": content for picture, content in tree.pictures.items()},
    }


def _packed(suffix: str, content: bytes) -> bytes:
    return gzip.compress(content, 9, mtime=0) if suffix.endswith(PACKED_SUFFIX) else content


def _unpacked(suffix: str, content: bytes) -> bytes:
    return gzip.decompress(content) if suffix.endswith(PACKED_SUFFIX) else content
