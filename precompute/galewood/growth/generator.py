"""Runs the generator of trees, which is written in TypeScript, in a child process.

The generator also runs in browsers, so there is one of it; tools/species/bundle.ts makes it one file that
Node runs without packages.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from galewood.options import IndividualRequest
from galewood.packaged import data_folder, species_folder
from galewood.util import Cancelled, GuardedProcess, shown_text

GENERATOR_FILE = "grower.mjs"
TIME_LIMIT_S = 120.0
"""A tree takes a second; a machine on which it takes longer than this is of no use."""
LOOK_INTERVAL_S = 0.1
"""Time between two questions whether the tree is still wanted, s."""
KEPT_ENVIRONMENT = ("PATH", "LANG", "LD_LIBRARY_PATH", "SYSTEMROOT")
SHOWN_CHARACTERS = 500
NEED_NODE = "Install Node 20 or newer (nodejs.org), and start again"


class GrowthError(ValueError):
    """A tree that cannot be grown; the message says why, and what to do."""


@dataclass(frozen=True)
class GrownFiles:
    """What the generator wrote: the mesh, and the document of its skeleton."""

    glb: bytes
    skeleton: bytes


def grow_files(
    species: str,
    request: IndividualRequest,
    *,
    wanted: Callable[[], bool] = lambda: True,
    time_limit_s: float = TIME_LIMIT_S,
) -> GrownFiles:
    """Grow an individual of a built-in species: the same request gives the same bytes.

    Once the tree is no longer ``wanted``, Node is ended, and Cancelled raised. Raises GrowthError if the
    species is none of the built-in ones, cannot have this size, or Node is missing, fails or exceeds the time
    limit.
    """
    node, generator = find_generator()
    document = {**request.model_dump(), "species": species, "pictures": str(_pictures(species, request))}
    with tempfile.TemporaryDirectory(prefix="galewood-") as name:
        folder = Path(name)
        program = [node, str(generator), json.dumps(document)]
        code, said = _run(program, folder, wanted, time_limit_s)
        if (folder / "refused.txt").exists():
            raise GrowthError(f"{(folder / 'refused.txt').read_text(encoding='utf-8')}.")
        if code != 0:
            raise GrowthError(f"Node ended with code {code}. {NEED_NODE}. It said: {said}")
        return GrownFiles((folder / "tree.glb").read_bytes(), (folder / "skeleton.json").read_bytes())


def find_generator() -> tuple[str, Path]:
    """Node, and the program that it runs. Raises GrowthError if one of them is missing."""
    node = shutil.which("node")
    if node is None:
        raise GrowthError(f"Trees are grown by Node, which was not found. {NEED_NODE}.")
    generator = data_folder("grower", "tools/species/dist") / GENERATOR_FILE
    if not generator.is_file():
        raise GrowthError(f"The generator of trees is missing ({generator}): `make build` makes it.")
    return node, generator


def _pictures(species: str, request: IndividualRequest) -> Path:
    """The built-in tree whose pictures the individual has."""
    entries = json.loads((species_folder() / "species.json").read_bytes())
    for entry in entries:
        if entry["species"] == species and entry["form"] == request.form:
            return species_folder() / str(entry["file"])
    known = ", ".join(dict.fromkeys(str(entry["species"]) for entry in entries))
    raise GrowthError(f"No built-in species is called {shown_text(species)!r}: choose one of {known}.")


def _run(
    program: list[str], folder: Path, wanted: Callable[[], bool], time_limit_s: float
) -> tuple[int, str]:
    """The exit code of a program, and the end of what it wrote to standard error."""
    environment = {name: os.environ[name] for name in KEPT_ENVIRONMENT if name in os.environ}
    environment["HOME"] = str(folder)
    end_s = time.monotonic() + time_limit_s
    with (
        (folder / "stderr").open("w+b") as errors,
        GuardedProcess(program, cwd=folder, environment=environment, errors=errors) as child,
    ):
        while True:
            if not wanted():
                raise Cancelled
            try:
                code = child.wait(LOOK_INTERVAL_S)
                break
            except subprocess.TimeoutExpired:
                if time.monotonic() > end_s:
                    message = (
                        f"Growing the tree took longer than {time_limit_s:g} s: try again on a free machine."
                    )
                    raise GrowthError(message) from None
    return code, shown_text((folder / "stderr").read_text(errors="replace")[-SHOWN_CHARACTERS:])
