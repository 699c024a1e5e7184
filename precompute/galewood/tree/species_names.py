"""Guessing the species from names in a file."""

from __future__ import annotations

import re

from galewood.formats import RawPart
from galewood.tree.pieces.names import spaced_name

SPECIES_NAMES = {
    "sycamore": r"sycamore|pseudo ?platan",  # also called Acer pseudoplatanus, so before the maple
    "poplar": r"poplar|aspen|populus|cottonwood|pappel|peuplier",
    "maple": r"maple|\bacer\b|ahorn|[ée]rable|platano[iï]d",
    "apricot": r"apricot|prunus|peach|cherry|aprikose|abricot",
    "ash": r"\bash\b|fraxinus|\besche|fr[êe]ne",
    "birch": r"birch|betula|birke|bouleau",
    "oak": r"\boaks?\b|quercus|(?<![a-z])eiche|ch[êe]ne",
    "plane": r"platan(?!o[iï]d)|plane ?tree",
    "beech": r"\bbeech|fagus|(?<![a-z])(?:rot)?buche|\bh[êe]tre",
    "spruce": r"\bspruce|picea|fichte|[ée]pic[ée]a",
    "pine": r"\bpines?\b|\bpinus|kiefer\b|\bpin sylvestre",
    "larch": r"\blarch|larix|\bl[äa]rche|m[ée]l[èe]ze",
    "willow": r"willow|\bsalix|(?<![a-z])weide|\bsaule",
    "conifer": r"conifer|\bfirs?\b|\babies\b|(?<![a-z])tanne|douglas|\bcedar",
}
"""Patterns of names in which spaces separate words (`spaced_name`), in the order in which they are tried."""

HABIT_NAMES = {
    "bonsai": r"bonsai|盆栽",
    "pot plant": r"\b(?:pot(?:ted)? ?plants?|house ?plants?|flower ?pot|zimmerpflanze)\b",
    "bush": r"\b(?:bush(?:es)?|shrubs?|hedges?|busch|strauch|hecke|buisson|arbusto|cespuglio)\b|куст",
}
"""Patterns of names of plants that are smaller than trees, by kind."""


def named_habit(text: str) -> str | None:
    """A kind of small plant, if a name says so."""
    spaced = spaced_name(text)
    return next((kind for kind, known in HABIT_NAMES.items() if re.search(known, spaced, re.I)), None)


def guess_species(given: str | None, filename: str, parts: list[RawPart]) -> tuple[str | None, str]:
    """The species and the reason: the given one, else one named in the file, else None."""
    if given:
        return given, "given"
    for text in [filename, *(label for part in parts for label in part.labels)]:
        for species, pattern in SPECIES_NAMES.items():
            if re.search(pattern, spaced_name(text), re.I):
                return species, f"named in {text[:80]!r}"
    return None, "no name indicates a species"
