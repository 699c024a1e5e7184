"""Individuals of the built-in species, grown from a seed."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from galewood.growth import GrownSkeleton, grow_files, read_skeleton
from galewood.io.api.keywords import with_keywords_of
from galewood.io.api.trees import Tree
from galewood.options import ImportRequest, IndividualRequest
from galewood.tree import read_tree, render_glb
from galewood.util import write_atomically


class GrowCall(IndividualRequest):
    """Everything that can be chosen about a tree that is grown in a program."""

    wanted: Callable[[], bool] | None = None


@dataclass(frozen=True)
class Individual:
    """A grown tree: a mesh of the size that was asked for, with branches of its own."""

    species: str
    request: IndividualRequest
    glb: bytes = field(repr=False)
    """Its mesh with pictures, as a binary glTF."""
    skeleton: GrownSkeleton = field(repr=False)
    """The axes and radii of its branches, as they were grown."""

    @property
    def name(self) -> str:
        """Species, form and seed, such as oak-forest-7."""
        form = "" if self.request.form == "open" else f"-{self.request.form}"
        return f"{self.species}{form}-{self.request.seed}"

    @cached_property
    def tree(self) -> Tree:
        """The tree as an import reads its mesh, for ``galewood.build`` and all that takes a ``Tree``."""
        options = ImportRequest(species=self.species, height_m=self.request.height_m)
        mesh = read_tree(self.glb, f"{self.name}.glb", options)
        return Tree(mesh, render_glb(mesh), self.name)

    def save(self, path: str | Path) -> None:
        """Write the mesh. OSError."""
        write_atomically(Path(path), self.glb)


@with_keywords_of(GrowCall)
def grow(species: str, options: GrowCall) -> Individual:
    """Grow an individual of a built-in species, in a second: the same values give the same bytes.

    Needs Node 20 or newer, which runs the generator that has grown the built-in trees.

    Args:
        species: One of the built-in species, such as "oak".
        options: ``seed``, from which the branches follow, ``height_m`` and ``dbh_cm``, the diameter at breast
            height; ``form``, "open" (default) or "forest". A function ``wanted`` is asked ten times a second
            whether to go on.

    Raises:
        GrowthError: The species is unknown or cannot have this size, or Node is missing or fails.
        Cancelled: The tree is not ``wanted`` any more.
        pydantic.ValidationError: An option is unknown or out of range.
    """
    request = IndividualRequest.model_validate(options.model_dump(exclude={"wanted"}))
    files = grow_files(species, request, wanted=options.wanted or (lambda: True))
    return Individual(species, request, files.glb, read_skeleton(files.skeleton))
