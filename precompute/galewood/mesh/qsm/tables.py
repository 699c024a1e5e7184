"""Cylinders from CSV files, by the names of their columns.

SimpleForest (``ID, parentID, startX … endZ, radius``; −1: no parent), aRchi and AdQSM (``startX … endZ,
cyl_ID, parent_ID, extension_ID, radius_cyl``; 0: no parent) and rTwig (``start_x …, id, parent``). The
separator is a comma, a semicolon or a tab.
"""

from __future__ import annotations

import csv
import re

import numpy as np

from galewood.mesh.qsm.cylinders import MOST, NO_CYLINDER, Cylinders, check_count
from galewood.util import Floats, Int64s, MeshError

SEPARATORS = ",;\t"
HEADER_BYTES = 8192
BROKEN = -2
COLUMNS = {
    "id": ("id", "cylid", "cylinderid"),
    "parent": ("parentid", "parent", "parentcylid"),
    "extension": ("extensionid", "extension"),
    "branch": ("branchid", "axisid", "branch"),
    "radius": ("radius", "radiuscyl", "cylradius"),
    "length": ("length", "lengthcyl", "cyllength"),
    **{
        f"{point}{axis}": (f"{point}{axis}", f"{point}{number}")
        for point in ("start", "end", "axis")
        for number, axis in enumerate("xyz", start=1)
    },
}
"""Names of each column, in lower case and without anything but letters and digits."""
STARTS, ENDS, AXES = (tuple(f"{point}{axis}" for axis in "xyz") for point in ("start", "end", "axis"))


def has_cylinder_columns(data: bytes) -> bool:
    """Whether a text file begins with the names of the columns of cylinders."""
    columns = _named(_header(_text(data[:HEADER_BYTES])))
    return all(name in columns for name in (*STARTS, "radius"))


def read_table(data: bytes) -> Cylinders:
    """The cylinders of a CSV file. Raises MeshError if columns are missing or a line cannot be read."""
    text = _text(data)
    columns = _named(_header(text))
    _check_columns(columns)
    rows = _rows(text, columns)
    start = np.column_stack([rows[name] for name in STARTS])
    if ENDS[0] in rows:
        end = np.column_stack([rows[name] for name in ENDS])
    else:
        axis = np.column_stack([rows[name] for name in AXES])
        end = start + rows["length"][:, None] * axis
    if "length" in rows and (rows["length"] < 0).any():
        raise MeshError(
            "cylinder-length",
            "unsuitable",
            f"{int((rows['length'] < 0).sum())} cylinders have a negative length.",
            "Remove or refit them and export the model again.",
        )
    known = rows["id"] if "id" in rows else np.arange(1.0, len(start) + 1)
    parent = _links(rows["parent"], known)
    if "branch" in rows:  # more reliable than an extension, which some programs give a side branch
        extension = _in_same_branch(parent, rows["branch"])
    else:
        extension = _links(rows["extension"], known) if "extension" in rows else np.full(len(start), -1)
    return Cylinders(start, end, rows["radius"], parent, extension)


def _in_same_branch(parent: Int64s, branch: Floats) -> Int64s:
    """The child (n,) of each cylinder that belongs to the same branch; −1: none."""
    extension = np.full(len(parent), NO_CYLINDER)
    child = np.flatnonzero((parent >= 0) & (branch == branch[parent]))
    extension[parent[child]] = child
    return extension


def _text(data: bytes) -> str:
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")  # decodes every byte; the names that matter are ASCII


def _header(text: str) -> list[str]:
    """Fields of the first line that is not blank; none if it is not text."""
    line = next(iter(text.lstrip().splitlines()), "")
    try:
        return next(csv.reader([line], delimiter=_separator(line)), [])
    except csv.Error:
        return []


def _separator(header: str) -> str:
    return max(SEPARATORS, key=header.count)


def _named(header: list[str]) -> dict[str, int]:
    """Position of each known column; the first of its names that occurs counts."""
    plain = [re.sub(r"[^a-z0-9]", "", name.lower()) for name in header]
    return {
        column: plain.index(next(name for name in names if name in plain))
        for column, names in COLUMNS.items()
        if any(name in plain for name in names)
    }


def _check_columns(columns: dict[str, int]) -> None:
    missing = [name for name in (*STARTS, "radius", "parent") if name not in columns]
    if not missing and not (all(name in columns for name in (*AXES, "length"))):
        missing = [name for name in ENDS if name not in columns]
    if missing:
        raise MeshError(
            "cylinder-columns",
            "unsuitable",
            f"The table has no columns {', '.join(missing)}.",
            "Export the cylinders with startX … endZ, radius, ID and parentID in the first line.",
        )


def _rows(text: str, columns: dict[str, int]) -> dict[str, Floats]:
    lines = text.lstrip().splitlines()
    separator = _separator(lines[0])
    width = max(columns.values()) + 1
    values: list[list[float]] = []
    for number, line in enumerate(lines[1:], start=2):
        if not line.strip():
            continue
        try:
            fields = next(csv.reader([line], delimiter=separator))
            if len(fields) < width:
                raise ValueError("too few fields")
            values.append([_number(fields[at], separator) for at in columns.values()])
        except (ValueError, csv.Error) as error:
            raise MeshError(
                "csv-syntax",
                "malformed",
                f"Line {number} of the table is invalid: {error}.",
                "Correct it, or export the table again.",
            ) from error
        if len(values) > MOST:
            check_count(len(lines) - 1)
    check_count(len(values))
    table = np.array(values, dtype=np.float64)
    return {name: table[:, at] for at, name in enumerate(columns)}


def _number(field: str, separator: str) -> float:
    text = field.strip().strip('"')
    if text in ("", "NA", "NaN", "nan"):
        return float("nan")
    return float(text.replace(",", ".") if separator == ";" else text)


def _links(named: Floats, known: Floats) -> Int64s:
    """(n,) row of the cylinder that each names; −1: none (0, negative or missing), −2: it does not exist."""
    order = np.argsort(known, kind="stable")
    ordered = known[order]
    if not np.isfinite(known).all() or (ordered[1:] == ordered[:-1]).any():
        raise MeshError(
            "cylinder-id",
            "unsuitable",
            "Some cylinders have no ID, or the same one as another.",
            "Give every cylinder an ID of its own and export the table again.",
        )
    wanted = np.where(np.isfinite(named), named, -1.0)
    at = np.minimum(np.searchsorted(ordered, wanted), len(known) - 1)
    exists = ordered[at] == wanted
    return np.where(exists, order[at], np.where(wanted <= 0, NO_CYLINDER, BROKEN)).astype(np.int64)
