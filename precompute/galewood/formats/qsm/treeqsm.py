"""Cylinders from the MATLAB files of TreeQSM.

Versions 2.3 and later store a struct ``cylinder`` inside ``QSM``, ``OptQSM`` or ``qsm``; 2.0 stores one
variable per quantity; older scripts and some exports store a matrix. Numbers of cylinders count from 1, and 0
means none. Only sandboxed processes may run this: the parser of scipy gets untrusted bytes.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from typing import Any

import numpy as np

from galewood.formats.qsm.cylinders import Cylinders, check_count
from galewood.formats.qsm.mat_nesting import MAX_DEPTH, is_too_deep
from galewood.util import Floats, Int64s, MeshError

HDF5_HEADER = b"\x89HDF\r\n\x1a\n"
FIELDS = ("radius", "length", "start", "axis", "parent", "extension")
OLD_VARIABLES = dict(zip(("Rad", "Len", "Sta", "Axe", "CPar", "CExt"), FIELDS, strict=True))
MATRIX_COLUMNS = {
    "radius": slice(0, 1), "length": slice(1, 2), "start": slice(2, 5), "axis": slice(5, 8),
    "parent": slice(8, 9), "extension": slice(9, 10),
}  # fmt: skip
MAX_NESTING = 5  # nesting of structs and cells
Struct = dict[str, Any]


def read_treeqsm(data: bytes) -> tuple[Cylinders, int]:
    """The cylinders of the first model in a file, and the number of models.

    Raises MeshError if the file cannot be read or has no cylinders.
    """
    found = list(_models(_variables(data)))
    if not found:
        raise MeshError(
            "no-cylinders",
            "unsuitable",
            "The MATLAB file has no TreeQSM cylinders.",
            "Save a variable QSM, OptQSM or qsm that has the field cylinder "
            f"(with {', '.join(FIELDS[:-1])}), or a matrix with the columns {', '.join(FIELDS)}.",
        )
    return _cylinders(found[0]), len(found)


def _variables(data: bytes) -> Struct:
    if data[:10] == b"MATLAB 7.3" or data[:8] == HDF5_HEADER:
        raise MeshError(
            "mat-version",
            "unsupported",
            "The file is in MATLAB's version 7.3 format, which is HDF5.",
            "Save it with save('tree.mat', 'QSM', '-v7') and try again.",
        )
    from scipy.io import loadmat  # slow to load

    try:
        if is_too_deep(data):
            raise MeshError(
                "nested-too-deep",
                "unsuitable",
                f"The cells and structs of the MATLAB file are nested deeper than {MAX_DEPTH} levels.",
                "Save the variable QSM alone, as TreeQSM made it.",
            )
        found = loadmat(io.BytesIO(data))
        return {name: value for name, value in found.items() if not name.startswith("__")}
    except (MemoryError, MeshError):
        raise
    except Exception as error:
        raise MeshError(
            "unreadable",
            "malformed",
            "The MATLAB file cannot be read.",
            "It is truncated or damaged; save it again with save('tree.mat', 'QSM', '-v7').",
        ) from error


def _models(variables: Struct) -> Iterator[Struct]:
    """The models of a file: structs first, then the separate variables of 2.0, then matrices."""
    if all(name in variables for name in OLD_VARIABLES):
        yield {field: variables[name] for name, field in OLD_VARIABLES.items()}
        return
    structs = [found for value in variables.values() for found in _structs(value, MAX_NESTING)]
    yield from structs
    if structs:
        return
    for value in variables.values():
        yield from _matrix(value)


def _matrix(value: Any) -> Iterator[Struct]:
    """The fields of a matrix of cylinders."""
    is_matrix = isinstance(value, np.ndarray) and value.dtype.kind in "fiu" and value.ndim == 2
    if is_matrix and value.shape[1] >= MATRIX_COLUMNS["extension"].stop:
        yield {field: value[:, columns] for field, columns in MATRIX_COLUMNS.items()}


def _structs(value: Any, depth: int) -> Iterator[Struct]:
    """Structs with the fields of cylinders, anywhere in nested structs and cells."""
    if not isinstance(value, np.ndarray) or depth == 0:
        return
    names = value.dtype.names
    if names is None:
        if value.dtype == object:
            for item in value.ravel():
                yield from _structs(item, depth - 1)
        return
    known = {name.lower(): name for name in names}
    for item in value.ravel():
        if all(field in known for field in FIELDS[:-1]):
            yield {field: item[known[field]] for field in FIELDS if field in known}
        elif "cylinder" in known:
            yield from _structs(item[known["cylinder"]], depth - 1)
            yield from _matrix(item[known["cylinder"]])
        else:
            for name in names:
                yield from _structs(item[name], depth - 1)


def _cylinders(model: Struct) -> Cylinders:
    try:
        radius, length = _numbers(model["radius"], 1)[:, 0], _numbers(model["length"], 1)[:, 0]
        start, axis = _numbers(model["start"], 3), _numbers(model["axis"], 3)
        parent = _links(model["parent"])
        extension = _links(model["extension"]) if "extension" in model else np.full(len(parent), -1)
        if len({len(radius), len(length), len(start), len(axis), len(parent), len(extension)}) != 1:
            raise ValueError("the fields have different lengths")
    except (ValueError, TypeError, OverflowError) as error:
        raise MeshError(
            "cylinder-fields",
            "malformed",
            f"The fields of the cylinders do not fit together: {error}.",
            "Save the model again, as TreeQSM made it.",
        ) from error
    check_count(len(radius))
    _check_axes(length, axis)
    with np.errstate(divide="ignore", invalid="ignore"):
        unit = axis / np.linalg.norm(axis, axis=1, keepdims=True)
    way = np.where(length[:, None] > 0, length[:, None] * unit, 0.0)
    return Cylinders(start, start + way, radius, parent, extension)


def _numbers(value: Any, width: int) -> Floats:
    """(n, width) numbers of a field."""
    rows = np.asarray(value, dtype=np.float64)
    return rows.reshape(-1, width) if width == 1 or rows.ndim != 2 else _wide(rows, width)


def _wide(rows: Floats, width: int) -> Floats:
    if rows.shape[1] != width:
        raise ValueError(f"a field has {rows.shape[1]} columns instead of {width}")
    return rows


def _links(value: Any) -> Int64s:
    """(n,) indices from 0 of cylinders that are numbered from 1; −1: none, −2: not a whole number."""
    rows = _numbers(value, 1)[:, 0]
    whole = np.isfinite(rows) & (rows == np.round(rows)) & (np.abs(rows) < 2**53)
    return np.where(whole, np.where(whole, rows, 0) - 1, -2).astype(np.int64)


def _check_axes(length: Floats, axis: Floats) -> None:
    bad = (length < 0) | ((length > 0) & ~(np.linalg.norm(axis, axis=1) > 0))
    if bad.any():
        raise MeshError(
            "cylinder-length",
            "unsuitable",
            f"{int(bad.sum())} cylinders have a negative length or no axis "
            f"(the first is cylinder {int(np.argmax(bad)) + 1}).",
            "Remove or refit them and save the model again.",
        )
