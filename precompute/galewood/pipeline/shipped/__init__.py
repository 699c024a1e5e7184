"""The results of a build that are distributed with the software: file format, reading and writing."""

from galewood.pipeline.shipped.files import (
    PICTURE_SUFFIX,
    SHIPPED_FOLDER,
    ShippedTree,
    build_key,
    read_shipped,
    write_shipped,
)

__all__ = ["PICTURE_SUFFIX", "SHIPPED_FOLDER", "ShippedTree", "build_key", "read_shipped", "write_shipped"]
