"""Recognises a text file of measurements by the names of its columns, and reads it."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from itertools import islice

from galewood.measurements.anemometer import Measurement, is_measurement, read_measurement
from galewood.measurements.inventory import Inventory, is_inventory, read_inventory, recognised_columns
from galewood.util import HEADER_WITHIN, Row, decoded, rows_of


class UnknownContentError(ValueError):
    """A file of another kind; it may be a tree."""


def read_data_file(
    data: bytes, *, start_s: float = 0.0, columns: Mapping[str, str] | None = None
) -> Inventory | Measurement:
    """Read the stems of an inventory (CSV, GeoJSON) or the record of an anemometer (CSV).

    ``start_s``: where the used part of a record begins, from its first sample. ``columns``: names of columns
    of an inventory, as for ``read_inventory``. Raises UnknownContentError for any other file, InventoryError
    or MeasurementError for one that is faulty, such as JSON that is no GeoJSON.
    """
    text = decoded(data)
    if text.lstrip().startswith("{"):
        return read_inventory(data, columns=columns)
    rows = _first_rows(text)
    if columns or is_inventory(rows):
        return read_inventory(data, columns=columns)
    if is_measurement(rows):
        return read_measurement(data, start_s=start_s)
    recognised = recognised_columns(rows, {})
    raise UnknownContentError(
        "no column names of an inventory ('x' and 'y' or 'lon' and 'lat', 'height' or 'dbh') or of an "
        "anemometer ('time', and 'speed' with 'direction' or 'u' and 'v') were found"
        + (f". Recognised: {recognised}" if recognised else "")
    )


def _first_rows(text: str) -> list[Row]:
    """Those before a cell that no table has: if they name columns, the reader reports its line."""
    found: list[Row] = []
    with suppress(ValueError):
        for row in islice(rows_of(text), HEADER_WITHIN):
            found.append(row)
    return found
