"""How complete the tables of one build are, from the first to the last."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:  # the service needs the names alone
    from galewood.pipeline.sampling import Samples
    from galewood.table import Table


class TableStage(StrEnum):
    """How complete a table is; the value is ``stage`` in its provenance.

    All but the complete one are preliminary: they play, and the next one replaces them.
    """

    left_out: tuple[str, ...]
    """What the table leaves out, in words."""

    def __new__(cls, name: str, left_out: tuple[str, ...]) -> Self:
        """A stage of this name."""
        stage = str.__new__(cls, name)
        stage._value_ = name
        stage.left_out = left_out
        return stage

    BEAMS = (
        "beams",
        (
            "the shape of the wood: its branches move as round beams",
            "the weight of the tree",
            "the change of stiffness, damping and wind load with the sway",
            "the curved paths of branches that bend far",
        ),
    )
    EARLY = "early", ("two thirds of the training runs",)
    COMPLETE = "complete", ()

    @property
    def file(self) -> str:
        """Name under which a build publishes the table."""
        return f"{self.value}.table"

    def samples(self, samples: Samples) -> Samples:
        """Those of a build's runs that the table is fitted to."""
        return samples.first() if self is TableStage.EARLY else samples

    def mark(self, table: Table) -> None:
        """Write the stage into the provenance of a table."""
        table.metadata["provenance"]["stage"] = self.value
        if self.left_out:
            table.metadata["provenance"] |= {"preliminary": True, "left_out": list(self.left_out)}
