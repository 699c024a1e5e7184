"""Cylinders from text tables, by the names of their columns.

SimpleForest (``ID, parentID, startX … endZ, radius``; −1: no parent), aRchi and AdQSM (``startX … endZ,
cyl_ID, parent_ID, extension_ID, radius_cyl``; 0: no parent), rTwig (``start_x …, id, parent``), and TreeQSM's
own text files. The separator is a comma, a semicolon, a tab or white space.
"""

from __future__ import annotations

import csv

import numpy as np

from galewood.formats.qsm.cylinders import MAX_CYLINDERS, NO_CYLINDER, Cylinders, check_count
from galewood.formats.qsm.header import Layout, decoded, layout_of, number, split
from galewood.util import Floats, Int64s, MeshError

HEADER_BYTES = 8192
BROKEN_PARENT = -2
STARTS, ENDS, AXES = (tuple(f"{point}{axis}" for axis in "xyz") for point in ("start", "end", "axis"))


def has_cylinder_columns(data: bytes) -> bool:
    """Whether a text file begins with the names, or the numbers, of the columns of cylinders."""
    columns = layout_of(decoded(data[:HEADER_BYTES]).splitlines()).columns
    return all(name in columns for name in (*STARTS, "radius"))


def read_table(data: bytes) -> Cylinders:
    """The cylinders of a CSV file. Raises MeshError if columns are missing or a line cannot be read."""
    lines = decoded(data).splitlines()
    layout = layout_of(lines)
    _check_columns(layout.columns)
    rows = _rows(lines, layout)
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


def _rows(lines: list[str], layout: Layout) -> dict[str, Floats]:
    width = max(layout.columns.values()) + 1
    values: list[list[float]] = []
    for at, line in enumerate(lines[layout.first_line :], start=layout.first_line + 1):
        if not line.strip():
            continue
        try:
            fields = split(line, layout.separator)
            if len(fields) < width:
                raise ValueError("too few fields")
            values.append([number(fields[column]) for column in layout.columns.values()])
        except (ValueError, csv.Error) as error:
            raise MeshError(
                "csv-syntax",
                "malformed",
                f"Line {at} of the table is invalid: {error}.",
                "Correct it, or export the table again.",
            ) from error
        if len(values) > MAX_CYLINDERS:
            check_count(len(lines) - layout.first_line)
    check_count(len(values))
    table = np.array(values, dtype=np.float64)
    return {name: table[:, at] for at, name in enumerate(layout.columns)}


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
    return np.where(exists, order[at], np.where(wanted <= 0, NO_CYLINDER, BROKEN_PARENT)).astype(np.int64)
