"""Mesh import options in requests and in the database, under their REST names."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # the mesh libraries are loaded with the first upload, not at startup
    from galewood.mesh import ImportOptions

IMPORT_FIELDS = ("species", "height_m", "up_axis", "wood_materials")


def import_options(given: dict[str, Any]) -> ImportOptions:
    """ImportOptions from REST fields; fields of a build are ignored."""
    from galewood.mesh import ImportOptions

    wood = given.get("wood_materials")
    return ImportOptions(
        species=given.get("species"),
        height_m=given.get("height_m"),
        up_axis=given.get("up_axis"),
        wood=tuple(wood) if wood else None,
    )
