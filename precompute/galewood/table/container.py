"""What both kinds of file share: safetensors with one JSON object of metadata, read with full checks."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any, Literal

import numpy as np
from safetensors import SafetensorError
from safetensors.numpy import load, save

from galewood.constants import MAX_TABLE_HEADER_BYTES
from galewood.util import Array

Metadata = dict[str, Any]
Foliage = Literal["leaf", "bare"]
"""Whether a tree has its leaves: a bare tree has only the mass and the wind area of its wood."""
Layout = dict[str, tuple[str, Any, int]]
"""Name in the file → (field of the dataclass, type, rank)."""
TYPES = {"F32": np.float32, "I16": np.int16, "U16": np.uint16, "U32": np.uint32}
"""By their names in safetensors."""


class TableError(ValueError):
    """The file is not valid; the message says what is wrong."""


def need(holds: bool, complaint: str) -> None:
    """Raise TableError with the complaint unless the condition holds."""
    if not holds:
        raise TableError(complaint)


def number(metadata: Metadata, name: str, low: float, high: float) -> float:
    """The number ``metadata[name]`` within low..high. Raises TableError."""
    value = metadata.get(name)
    real = isinstance(value, int | float) and not isinstance(value, bool) and low <= value <= high
    need(real, f"metadata {name}: expected a number in {low:g}..{high:g}, not {value!r:.40}")
    return float(metadata[name])


def whole(metadata: Metadata, name: str, high: int) -> int:
    """The whole number ``metadata[name]`` within 1..high. Raises TableError."""
    found = number(metadata, name, 1, high)
    need(found % 1 == 0, f"metadata {name}: expected a whole number")
    return int(found)


def foliage_of(metadata: Metadata) -> Foliage:
    """Whether a table was made from the tree in leaf or bare; without the key: in leaf. Raises TableError."""
    found = metadata.get("foliage", "leaf")
    need(found in ("leaf", "bare"), f"metadata foliage: expected 'leaf' or 'bare', not {found!r:.40}")
    return "bare" if found == "bare" else "leaf"


def read_metadata(data: bytes) -> Metadata:
    """Read the metadata of a file without checking it, for any version. Raises TableError."""
    if len(data) < 8:
        raise TableError("truncated table file: no header")
    length = int.from_bytes(data[:8], "little")
    if length > MAX_TABLE_HEADER_BYTES or 8 + length > len(data):
        raise TableError("truncated table file, or not a table: the header does not fit")
    try:
        header = json.loads(data[8 : 8 + length])
        metadata = json.loads(header["__metadata__"]["galewood"])
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise TableError("not a galewood table: no readable metadata") from error
    if not isinstance(metadata, dict):
        raise TableError("not a galewood table: metadata is not an object")
    return metadata


def check_format(metadata: Metadata, name: str, version: int) -> None:
    """Raise TableError unless the metadata is that of a file of this format and version."""
    found = metadata.get("format")
    need(found == name, f"not a {name}: format {found!r:.40}")
    given, kind = metadata.get("version"), name.removeprefix("galewood-")
    need(
        given == version and given is not True,
        f"{kind} version {given!r:.40}; this reader knows version {version}",
    )


def layout(tensors: Mapping[str, tuple[str, int]], fields: Mapping[str, str]) -> Layout:
    """The layout of tensors (name → type and rank) whose values are these fields (name → field)."""
    return {name: (fields[name], TYPES[kind], rank) for name, (kind, rank) in tensors.items()}


def read_tensors(data: bytes) -> dict[str, Array]:
    """All tensors of a file by name. Raises TableError."""
    try:
        return load(data)
    except (SafetensorError, ValueError, TypeError, KeyError) as error:
        raise TableError(f"damaged table file: {error}") from error


def write(tensors: dict[str, Array], metadata: Metadata) -> bytes:
    """Encode tensors and metadata."""
    return save(tensors, {"galewood": json.dumps(metadata, allow_nan=False, separators=(",", ":"))})


def fields(tensors: dict[str, Array], layout: Layout) -> dict[str, Any]:
    """The tensors of a layout by field, of the expected type and rank. Raises TableError."""
    return {field: _tensor(tensors, name, dtype, rank) for name, (field, dtype, rank) in layout.items()}


def _tensor(tensors: dict[str, Array], name: str, dtype: Any, rank: int) -> Array:
    if name not in tensors:
        raise TableError(f"missing tensor {name}")
    tensor = tensors[name]
    if tensor.dtype != dtype or tensor.ndim != rank:
        raise TableError(f"tensor {name}: expected {np.dtype(dtype).name} of rank {rank}")
    return tensor


def tensors_of(part: object, layout: Layout) -> dict[str, Array]:
    """The fields of a dataclass as tensors by name."""
    return {
        name: np.ascontiguousarray(getattr(part, field), dtype) for name, (field, dtype, _) in layout.items()
    }


def check_shapes(part: object, layout: Layout, expected: dict[str, tuple[int, ...]]) -> None:
    """Raise TableError unless the tensors have the expected shapes."""
    for name, shape in expected.items():
        found = getattr(part, layout[name][0]).shape
        need(found == shape, f"tensor {name}: shape {found}, expected {shape}")


def check_finite(part: object, layout: Layout) -> None:
    """Raise TableError unless all floating-point tensors are finite."""
    for name, (field, dtype, _) in layout.items():
        if dtype == np.float32:
            need(bool(np.isfinite(getattr(part, field)).all()), f"tensor {name}: not finite")
