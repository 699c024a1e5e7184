"""Options of mesh import and build: one validated model for the command line and the REST interface."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from galewood.options.request import BuildRequest, ImportRequest, MaterialName, import_options

__all__ = ["BuildRequest", "ImportRequest", "MaterialName", "import_options"]
