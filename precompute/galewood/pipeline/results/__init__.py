"""The result of a build, and the forms in which it is distributed with the software."""

from galewood.pipeline.results.light import (
    DRAWN_SPRAYS_NAME,
    LIGHT_FOLDER,
    PICTURES_FOLDER,
    SHOOTS_NAME,
    SPRAYS_NAME,
    light_like,
    light_mesh,
    write_light,
)
from galewood.pipeline.results.result import BuildResult, bare_path, read_compliance, write_compliance
from galewood.pipeline.results.shipped import (
    BUILTIN_OPTIONS,
    PICTURE_SUFFIX,
    SHIPPED_FOLDER,
    ShippedTree,
    build_key,
    forms_path,
    motions_path,
    read_shipped,
    shipped_bare_tables,
    shipped_tables,
    write_shipped,
)

__all__ = [
    "BUILTIN_OPTIONS",
    "DRAWN_SPRAYS_NAME",
    "LIGHT_FOLDER",
    "PICTURES_FOLDER",
    "PICTURE_SUFFIX",
    "SHIPPED_FOLDER",
    "SHOOTS_NAME",
    "SPRAYS_NAME",
    "BuildResult",
    "ShippedTree",
    "bare_path",
    "build_key",
    "forms_path",
    "light_like",
    "light_mesh",
    "motions_path",
    "read_compliance",
    "read_shipped",
    "shipped_bare_tables",
    "shipped_tables",
    "write_compliance",
    "write_light",
    "write_shipped",
]
