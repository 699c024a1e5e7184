"""Conversion in a child process with limits, for services: anyone may send a file."""

from __future__ import annotations

import json

import numpy as np

from galewood.measurements.data_file import UnknownContentError, read_data_file
from galewood.measurements.errors import MeasurementError
from galewood.measurements.inventory import InventoryError
from galewood.sandbox import Arrays, Limits, run_limited
from galewood.util import MeshError

LIMITS = Limits(memory_bytes=3 << 30, cpu_s=120)
REFUSALS = frozenset(("bad-inventory", "bad-measurement", "unknown-content"))
"""Codes of the errors that the reader itself raises."""


def convert_limited(data: bytes | memoryview, start_s: float = 0.0) -> bytes:
    """Read a data file in a child process and return its document as JSON. Raises MeshError.

    The document is the inventory document, or the ``wind`` and the ``report`` of a measurement.
    """
    arguments = {"data": np.frombuffer(data, np.uint8), "start_s": np.array(start_s)}
    target = "galewood.measurements.limited:convert_in_child"
    try:
        return run_limited(target, arguments, LIMITS, what="Reading the file")["json"].tobytes()
    except MeshError as error:
        if error.code in REFUSALS:
            raise
        raise MeshError(error.code, error.reason, error.title, "Split the file.") from error


def convert_in_child(arguments: Arrays) -> Arrays:
    """Entry point of the child process of ``convert_limited``."""
    try:
        found = read_data_file(arguments["data"].tobytes(), start_s=float(arguments["start_s"]))
    except UnknownContentError as error:
        raise MeshError(
            "unknown-content", "unsupported", "The file is not a table of measurements.", _sentence(error)
        ) from error
    except InventoryError as error:
        raise MeshError(
            "bad-inventory", "unsuitable", "The inventory could not be read.", _sentence(error)
        ) from error
    except MeasurementError as error:
        raise MeshError(
            "bad-measurement", "unsuitable", "The measurement could not be read.", _sentence(error)
        ) from error
    document = json.dumps(found.document(), separators=(",", ":"))
    return {"json": np.frombuffer(document.encode(), np.uint8)}


def _sentence(error: ValueError) -> str:
    text = str(error)
    return f"{text[:1].upper()}{text[1:]}."
