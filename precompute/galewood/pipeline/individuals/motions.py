"""The motion of a species without dimensions, and the file that has those of the built-in trees."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from galewood.packaged import species_folder
from galewood.pipeline.results import motions_path


@dataclass(frozen=True)
class SpeciesMotion:
    """The motion of a species without dimensions.

    ``stiffness``: factors of the first modes, finite elements over beams. The largest sampled sway over the
    height, and the largest speed and pressure at it, in the units of the sway. ``force``: the isotropic law.
    """

    stiffness: tuple[float, ...]
    sway: float
    speed: float
    pressure: float
    force: tuple[float, ...]


@dataclass(frozen=True)
class SpeciesMotions:
    """The motion of a species in leaf, and without leaves; None for a species that keeps them."""

    leaf: SpeciesMotion
    bare: SpeciesMotion | None = None

    def document(self) -> dict[str, Any]:
        """As a JSON object, for ``motions_of_document``."""
        bare = {} if self.bare is None else {"bare": asdict(self.bare)}
        return {**asdict(self.leaf), **bare}


def shipped_motions(species: str, form: str, folder: Path | None = None) -> SpeciesMotions:
    """The motion of a built-in species grown in this form. KeyError for others; OSError."""
    folder = folder or species_folder()
    entries = json.loads((folder / "species.json").read_bytes())
    name = {(one["species"], one["form"]): one["id"] for one in entries}[species, form]
    return motions_of_document(json.loads(motions_path(folder).read_bytes())["motions"][name])


def motions_of_document(document: dict[str, Any]) -> SpeciesMotions:
    """The motion that a JSON object holds. Raises ValueError for another object."""
    bare = document.get("bare")
    return SpeciesMotions(_motion_of(document), None if bare is None else _motion_of(bare))


def _motion_of(document: dict[str, Any]) -> SpeciesMotion:
    try:
        return SpeciesMotion(
            tuple(float(one) for one in document["stiffness"]),
            float(document["sway"]),
            float(document["speed"]),
            float(document["pressure"]),
            tuple(float(one) for one in document["force"]),
        )
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError(f"not the motion of a species: {error}") from None
