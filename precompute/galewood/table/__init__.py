"""The table file format: encodes a Table to bytes and decodes it again; the paper's records are optional."""

from galewood.table.compliance import Compliance, decode_compliance, encode_compliance
from galewood.table.container import Foliage, Metadata, TableError, read_metadata
from galewood.table.format import Table, decode, encode, with_records
from galewood.table.records import Records, encode_records

__all__ = [
    "Compliance",
    "Foliage",
    "Metadata",
    "Records",
    "Table",
    "TableError",
    "decode",
    "decode_compliance",
    "encode",
    "encode_compliance",
    "encode_records",
    "read_metadata",
    "with_records",
]
