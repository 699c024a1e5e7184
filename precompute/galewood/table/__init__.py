"""The table file format: encodes a Table to bytes and decodes it again; the paper's records are optional."""

from galewood.table.compliance import Compliance, decode_compliance, encode_compliance
from galewood.table.container import Foliage, Metadata, TableError, foliage_of, read_metadata
from galewood.table.drawn import (
    LONGEST,
    NodePose,
    drawn_positions,
    joint_rows,
    node_pose,
    turned,
    unstretched,
    vertex_rows,
)
from galewood.table.format import FORMAT, VERSION, Table, decode, encode, with_records, without_gusts
from galewood.table.records import Records, encode_records

__all__ = [
    "FORMAT",
    "LONGEST",
    "VERSION",
    "Compliance",
    "Foliage",
    "Metadata",
    "NodePose",
    "Records",
    "Table",
    "TableError",
    "decode",
    "decode_compliance",
    "drawn_positions",
    "encode",
    "encode_compliance",
    "encode_records",
    "foliage_of",
    "joint_rows",
    "node_pose",
    "read_metadata",
    "turned",
    "unstretched",
    "vertex_rows",
    "with_records",
    "without_gusts",
]
