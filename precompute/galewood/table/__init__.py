"""The table file format: encodes a Table to bytes and decodes it again."""

from galewood.table.format import (
    FORMAT,
    VERSION,
    Metadata,
    Table,
    TableError,
    decode,
    encode,
    poses,
    read_metadata,
)

__all__ = [
    "FORMAT",
    "VERSION",
    "Metadata",
    "Table",
    "TableError",
    "decode",
    "encode",
    "poses",
    "read_metadata",
]
