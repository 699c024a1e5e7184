"""What a user may choose about a grown tree."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

GrownForm = Literal["open", "forest"]
MAX_SEED = 2**32 - 1


class IndividualRequest(BaseModel):
    """Size and branching of an individual of a built-in species.

    The sizes that its species can have are checked by the generator, which knows the species.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    seed: int = Field(ge=0, le=MAX_SEED, description="The branches follow from this whole number.")
    height_m: float = Field(gt=0, allow_inf_nan=False, description="Height of the topmost leaf, m.")
    dbh_cm: float | None = Field(
        default=None,
        gt=0,
        allow_inf_nan=False,
        description="Diameter of the stem at breast height (1.3 m), cm; default: in proportion to height.",
    )
    form: GrownForm = Field(
        default="open", description="Grown in the open, or in a closed forest: slender with a high crown."
    )
    nearest_size: bool = Field(
        default=False,
        description="Take the nearest size that the species can have; otherwise other sizes are refused.",
    )
