"""What a user said about a mesh, kept with its tree under the names of the interface."""

from __future__ import annotations

from typing import Any

from galewood.mesh import ImportOptions

NAMES = ("species", "height_m", "up_axis", "wood_materials")


def import_options(given: dict[str, Any]) -> ImportOptions:
    """The options of intake; names that belong to a build are passed over."""
    wood = given.get("wood_materials")
    return ImportOptions(
        species=given.get("species"),
        height_m=given.get("height_m"),
        up_axis=given.get("up_axis"),
        wood=tuple(wood) if wood else None,
    )
