"""Reports in a child process with limits, for services: anyone may send an inventory.

The packages of the finite elements are loaded in the child only.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

import numpy as np

from galewood.measurements import InventoryError, read_inventory
from galewood.packaged import species_folder
from galewood.pipeline.results import forms_path
from galewood.sandbox import Arrays, Limits, from_json_array, run_limited, to_bytes_array, to_json_array
from galewood.table import Foliage
from galewood.util import MeshError

LIMITS = Limits(memory_bytes=3 << 30, cpu_s=60)
MOST_STEMS = 5000
"""Of a report by a service: some seconds of work, and an answer of 3 MB."""
REFUSALS = frozenset(("bad-inventory", "too-many-stems"))
"""Codes of the errors that the child itself raises."""

ReportKind = Literal["json", "csv"]


def stand_limited(
    data: bytes | memoryview,
    foliage: Foliage,
    wind_m_s: float,
    kind: ReportKind = "json",
    wanted: Callable[[], bool] = lambda: True,
) -> bytes:
    """The report of an inventory (CSV, GeoJSON, document), computed in a child process. Raises MeshError.

    ``kind``: JSON, with the stems in the order of the inventory, or a table (CSV), by rank. Once it is no
    longer ``wanted``, Cancelled is raised.
    """
    arguments = {
        "data": np.frombuffer(data, np.uint8),
        "forms": to_bytes_array(forms_path(species_folder()).read_bytes()),
        "asked": to_json_array({"foliage": foliage, "wind_m_s": wind_m_s, "kind": kind}),
    }
    target, what = "galewood.check.stand.limited:stand_in_child", "The report of the stand"
    try:
        return run_limited(target, arguments, LIMITS, what=what, wanted=wanted)["report"].tobytes()
    except MeshError as error:
        if error.code in REFUSALS:
            raise
        raise MeshError(error.code, error.reason, error.title, "Split the file.") from error


def stand_in_child(arguments: Arrays) -> Arrays:
    """Entry point of the child process of ``stand_limited``."""
    try:
        inventory = read_inventory(arguments["data"].tobytes())
    except InventoryError as error:
        text = str(error)
        hint = f"{text[:1].upper()}{text[1:]}."
        raise MeshError("bad-inventory", "unsuitable", "The inventory could not be read.", hint) from error
    if (count := len(inventory.stems)) > MOST_STEMS:
        raise MeshError(
            "too-many-stems",
            "too-large",
            f"The inventory has {count} stems; this service computes the wind risk of at most {MOST_STEMS}.",
            "Send a part of the stand, or use `galewood stand`, which has no such limit.",
        )
    from galewood.check.stand.form_file import forms_in
    from galewood.check.stand.report import StandOptions, stand_report
    from galewood.check.stand.writing import table_text

    asked = from_json_array(arguments["asked"])
    forms = forms_in(arguments["forms"].tobytes(), asked["foliage"])
    found = stand_report(inventory, forms, StandOptions(wind_m_s=asked["wind_m_s"]))
    if asked["kind"] == "csv":
        return {"report": to_bytes_array(table_text(found).encode())}
    document = found.document()
    document["stems"].sort(key=_index)
    return {"report": to_json_array(document)}


def _index(stem: dict[str, Any]) -> int:
    return stem["index"]
