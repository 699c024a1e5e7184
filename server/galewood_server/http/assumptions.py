"""What a user said about a mesh; it is kept with the tree under the names of the REST interface."""

from __future__ import annotations

from typing import Any

from galewood.mesh import ImportOptions
from galewood.options import ImportRequest
from galewood.options import import_options as options_of_request

NAMES = tuple(ImportRequest.model_fields)


def import_options(given: dict[str, Any]) -> ImportOptions:
    """The options of mesh import; names that belong to a build are ignored."""
    return options_of_request(ImportRequest.model_validate({n: given[n] for n in NAMES if n in given}))
