"""Individuals of the built-in species, grown from a seed, and their motion from that of the species."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from galewood.growth import GrownSkeleton, GrowthError, grow_files, read_skeleton
from galewood.io.api.keywords import with_keywords_of
from galewood.io.api.tables import MotionTable
from galewood.io.api.trees import Tree
from galewood.options import IndividualRequest
from galewood.pipeline.individuals import (
    GrownMesh,
    IndividualDocument,
    SpeciesMotions,
    document_of,
    quick_motion,
    read_document,
    read_grown,
)
from galewood.table import Foliage
from galewood.util import write_atomically


class GrowCall(IndividualRequest):
    """Everything that can be chosen about a tree that is grown in a program."""

    wanted: Callable[[], bool] | None = None


@dataclass(frozen=True)
class Individual:
    """A grown tree: a mesh of the size that was asked for, with branches of its own."""

    species: str
    request: IndividualRequest
    motions: SpeciesMotions = field(repr=False)
    """What its motion takes over from the fitted tables of its species."""
    glb: bytes = field(repr=False)
    """Its mesh with pictures, as a binary glTF."""
    skeleton: GrownSkeleton = field(repr=False)
    """The axes and radii of its branches, as they were grown."""

    @property
    def name(self) -> str:
        """Species, form and seed, such as oak-forest-7."""
        return self._document.name

    @property
    def _document(self) -> IndividualDocument:
        return IndividualDocument(self.species, self.request, self.motions)

    @cached_property
    def tree(self) -> Tree:
        """The tree as an import reads its mesh, for ``galewood.build`` and all that takes a ``Tree``."""
        grown = read_grown(self._document, self.glb)
        return Tree(grown.tree, grown.render_glb, self.name)

    def table(self, foliage: Foliage = "leaf") -> MotionTable:
        """Its motion in leaf or bare, within seconds: its own beams, and the nonlinear force of its species.

        ``galewood.build(individual.tree)`` takes a minute and simulates it instead. Raises ValueError for
        the bare table of a species that keeps its leaves.
        """
        tree = self.tree
        data, report = quick_motion(self._document, GrownMesh(tree.mesh, tree.render_glb), foliage)
        return MotionTable(data, tree.render_glb, report, name=self.name)

    def document(self) -> bytes:
        """All that is needed to grow it again, with the same table, as JSON of some hundred bytes."""
        return self._document.encoded()

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
            height (default: in proportion to the height); ``form``, "open" (default) or "forest";
            ``nearest_size`` takes the nearest size that the species can have. A function ``wanted`` is asked
            ten times a second whether to go on.

    Raises:
        GrowthError: The species is unknown or cannot have this size, or Node is missing or fails.
        Cancelled: The tree is not ``wanted`` any more.
        pydantic.ValidationError: An option is unknown or out of range.
    """
    request = IndividualRequest.model_validate(options.model_dump(exclude={"wanted"}))
    files = grow_files(species, request, wanted=options.wanted or (lambda: True))
    motions = document_of(species, request).motions
    return Individual(species, request, motions, files.glb, read_skeleton(files.skeleton))


def regrow(document: bytes | str) -> Individual:
    """Grow an individual again, from its ``document()``: the same mesh and the same table.

    Raises:
        GrowthError: The document is not that of an individual; or as ``grow``.
    """
    try:
        known = read_document(document)
    except ValueError as error:
        raise GrowthError(str(error)) from None
    files = grow_files(known.species, known.request)
    return Individual(known.species, known.request, known.motions, files.glb, read_skeleton(files.skeleton))
