"""Options of mesh import and build: one validated model for the command line and the REST interface."""

from galewood.options.request import BuildRequest, ImportRequest, MaterialName, import_options

__all__ = ["BuildRequest", "ImportRequest", "MaterialName", "import_options"]
