"""The results of a build that are distributed with the software: file format, reading and writing."""

from galewood.shipped.files import ShippedTree, build_key, read_shipped, write_shipped

__all__ = ["ShippedTree", "build_key", "read_shipped", "write_shipped"]
