"""How complete the tables of one build are, from the first to the last."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # the service needs the names alone
    from galewood.table import Table

LEFT_OUT_BY_BEAMS = (
    "the shape of the wood: its branches move as round beams",
    "the weight of the tree",
    "the change of stiffness, damping and wind load with the sway",
    "the curved paths of branches that bend far",
)


class TableStage(StrEnum):
    """How complete a table is; the value is ``stage`` in its provenance."""

    BEAMS = "beams"
    """Preliminary: it plays until the complete one replaces it."""
    COMPLETE = "complete"

    @property
    def file(self) -> str:
        """Name under which a build publishes the table."""
        return f"{self.value}.table"

    def mark(self, table: Table) -> None:
        """Write the stage, and what it leaves out, into the provenance of a table."""
        table.metadata["provenance"]["stage"] = self.value
        if self is TableStage.BEAMS:
            table.metadata["provenance"] |= {"preliminary": True, "left_out": list(LEFT_OUT_BY_BEAMS)}
