"""Mesh import options in requests and in the database, under their REST names."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from galewood.options import ImportRequest
from galewood.options import import_options as options_of_request

if TYPE_CHECKING:  # the mesh libraries are loaded with the first upload, not at startup
    from galewood.mesh import ImportOptions

IMPORT_FIELDS = tuple(ImportRequest.model_fields)


def import_options(given: dict[str, Any]) -> ImportOptions:
    """ImportOptions from REST fields; fields of a build are ignored."""
    fields = {name: given[name] for name in IMPORT_FIELDS if name in given}
    return options_of_request(ImportRequest.model_validate(fields))
