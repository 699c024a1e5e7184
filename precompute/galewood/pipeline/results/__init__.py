"""The result of a build, and the form in which it is distributed with the software."""

from galewood.pipeline.results.result import BuildResult, bare_path
from galewood.pipeline.results.shipped import (
    BUILTIN_OPTIONS,
    PICTURE_SUFFIX,
    SHIPPED_FOLDER,
    ShippedTree,
    build_key,
    read_shipped,
    write_shipped,
)

__all__ = [
    "BUILTIN_OPTIONS",
    "PICTURE_SUFFIX",
    "SHIPPED_FOLDER",
    "BuildResult",
    "ShippedTree",
    "bare_path",
    "build_key",
    "read_shipped",
    "write_shipped",
]
