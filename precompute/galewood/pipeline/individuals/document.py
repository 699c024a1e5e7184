"""The document of an individual: all that is needed to grow it again, with the same table."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from galewood.options import IndividualRequest
from galewood.pipeline.individuals.motions import SpeciesMotions, motions_of_document, shipped_motions

DOCUMENT_FORMAT, DOCUMENT_VERSION = "galewood-individual", 1


@dataclass(frozen=True)
class IndividualDocument:
    """A species, what was asked for, and what the motion takes over from the fitted tables of the species."""

    species: str
    request: IndividualRequest
    motions: SpeciesMotions = field(repr=False)

    @property
    def name(self) -> str:
        """Species, form and seed, such as oak-forest-7."""
        form = "" if self.request.form == "open" else f"-{self.request.form}"
        return f"{self.species}{form}-{self.request.seed}"

    def encoded(self) -> bytes:
        """As JSON of some hundred bytes."""
        values: dict[str, Any] = {
            "format": DOCUMENT_FORMAT,
            "version": DOCUMENT_VERSION,
            "species": self.species,
            **self.request.model_dump(exclude_none=True, exclude={"nearest_size"}),
            **({"nearest_size": True} if self.request.nearest_size else {}),
            "motion": self.motions.document(),
        }
        return (json.dumps(values, separators=(",", ":")) + "\n").encode()


def document_of(species: str, request: IndividualRequest, folder: Path | None = None) -> IndividualDocument:
    """The document of an individual of a built-in species, before it is grown. KeyError for others; OSError.

    ``folder`` has the built-in trees; default: that of this installation.
    """
    return IndividualDocument(species, request, shipped_motions(species, request.form, folder))


def read_document(content: bytes | str) -> IndividualDocument:
    """Read the document of an individual. Raises ValueError, which says what is wrong, for another one."""
    try:
        values = json.loads(content)
        if (values.pop("format"), values.pop("version")) != (DOCUMENT_FORMAT, DOCUMENT_VERSION):
            raise ValueError("another format or version")
        species, motions = str(values.pop("species")), motions_of_document(values.pop("motion"))
        return IndividualDocument(species, IndividualRequest.model_validate(values), motions)
    except KeyError as error:
        raise ValueError(f"Not the document of an individual: it lacks {error}") from None
    except (AttributeError, TypeError, ValueError) as error:
        raise ValueError(f"Not the document of an individual: {error}") from None
