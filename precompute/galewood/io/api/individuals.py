"""Individuals of the built-in species, grown from a seed, and their motion from that of the species."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from galewood.growth import GrownSkeleton, GrowthError, grow_files, read_skeleton
from galewood.io.api.keywords import with_keywords_of
from galewood.io.api.tables import MotionTable
from galewood.io.api.trees import Tree
from galewood.options import ImportRequest, IndividualRequest
from galewood.pipeline.individuals import SpeciesMotion, individual_table, motion_of_document, shipped_motion
from galewood.pipeline.tables import BuildOptions
from galewood.table import encode
from galewood.threads import single_threaded
from galewood.tree import read_tree, render_glb
from galewood.util import write_atomically

DOCUMENT_FORMAT, DOCUMENT_VERSION = "galewood-individual", 1


class GrowCall(IndividualRequest):
    """Everything that can be chosen about a tree that is grown in a program."""

    wanted: Callable[[], bool] | None = None


@dataclass(frozen=True)
class Individual:
    """A grown tree: a mesh of the size that was asked for, with branches of its own."""

    species: str
    request: IndividualRequest
    motion: SpeciesMotion = field(repr=False)
    """What its motion takes over from the fitted table of its species."""
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

    @single_threaded
    def table(self) -> MotionTable:
        """Its motion in leaf, within seconds: its own beams, and the nonlinear force of its species.

        ``galewood.build(individual.tree)`` takes a minute and simulates it instead.
        """
        options = BuildOptions(species=self.species, height_m=self.request.height_m, stiffness="as drawn")
        table = individual_table(self.tree.mesh, self.motion, options, self.tree.render_glb)
        report = {"individual": json.loads(self.document()), "drawn": table.metadata.get("drawn", {})}
        return MotionTable(encode(table), self.tree.render_glb, report, name=self.name)

    def document(self) -> bytes:
        """All that is needed to grow it again, with the same table, as JSON of some hundred bytes."""
        values: dict[str, Any] = {
            "format": DOCUMENT_FORMAT,
            "version": DOCUMENT_VERSION,
            "species": self.species,
            **self.request.model_dump(),
            "motion": asdict(self.motion),
        }
        return (json.dumps(values, separators=(",", ":")) + "\n").encode()

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
    motion = shipped_motion(species, request.form)
    return Individual(species, request, motion, files.glb, read_skeleton(files.skeleton))


def regrow(document: bytes | str) -> Individual:
    """Grow an individual again, from its ``document()``: the same mesh and the same table.

    Raises:
        GrowthError: The document is not that of an individual; or as ``grow``.
    """
    try:
        values = json.loads(document)
        if (values.pop("format"), values.pop("version")) != (DOCUMENT_FORMAT, DOCUMENT_VERSION):
            raise ValueError("another format or version")
        species, motion = str(values.pop("species")), motion_of_document(values.pop("motion"))
        request = IndividualRequest.model_validate(values)
    except KeyError as error:
        raise GrowthError(f"Not the document of an individual: it lacks {error}") from None
    except (AttributeError, TypeError, ValueError) as error:
        raise GrowthError(f"Not the document of an individual: {error}") from None
    files = grow_files(species, request)
    return Individual(species, request, motion, files.glb, read_skeleton(files.skeleton))
