"""The table file format; in: a Table; out: bytes, and back."""

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
