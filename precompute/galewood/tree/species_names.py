"""Guessing the species from names in a file."""

from __future__ import annotations

import re

from galewood.formats import RawPart

NAMES = {
    "sycamore": r"sycamore|pseudoplatan",  # also called Acer pseudoplatanus, so before the maple
    "poplar": r"poplar|aspen|populus|cottonwood|pappel|peuplier",
    "maple": r"maple|acer\b|ahorn|[ée]rable",
    "apricot": r"apricot|prunus|peach|cherry|aprikose|abricot",
    "ash": r"(?<![a-z])ash(?![a-z])|fraxinus|esche|fr[êe]ne",
    "birch": r"birch|betula|birke|bouleau",
    "oak": r"(?<![a-z])oaks?(?![a-z])|quercus|eiche|ch[êe]ne",
    "plane": r"(?<!pseudo)platan|plane.?tree",
}


def guess_species(given: str | None, filename: str, parts: list[RawPart]) -> tuple[str | None, str]:
    """The species and the reason: the given one, else one named in the file, else None."""
    if given:
        return given, "given"
    for text in [filename, *(label for part in parts for label in part.labels)]:
        for species, pattern in NAMES.items():
            if re.search(pattern, text, re.I):
                return species, f"named in {text[:80]!r}"
    return None, "no name indicates a species"
