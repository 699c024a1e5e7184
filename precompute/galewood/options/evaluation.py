"""What a user may choose about an evaluation of a table."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

EvaluationSeed = Annotated[
    int, Field(ge=0, lt=2**31, description="Seed of the winds, their gusts, and the tree's place.")
]
EVALUATION_SEED = 20_001
EVALUATION_FRAMES = 660
EVALUATION_PEAK_RATIO = 0.65
"""Peak speed of the uniform winds over the design speed of the table."""


class EvaluationOptions(BaseModel):
    """The unseen winds of an evaluation, and what is simulated in them."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    frames: int = Field(default=EVALUATION_FRAMES, ge=60, description="Frames of each wind, 1/30 s each.")
    strength: float = Field(
        default=EVALUATION_PEAK_RATIO, description="Peak speed of the uniform winds over the design speed."
    )
    sway: float | None = Field(
        default=None,
        description="Scale each wind instead until the tree sways by this share of its height, at most to "
        "the strongest wind that the table was made from (uniform winds) or a mean speed of 60 m/s (gusts).",
    )
    seed: EvaluationSeed = EVALUATION_SEED
    long: int = Field(
        default=0, description="Frames of an extra long run of gusts at --sway (default 0.1), and beyond."
    )
    workers: int = Field(default=2, description="Processes for the finite-element simulations.")
    converged: bool = Field(
        default=False,
        description="Also compare with time steps a quarter as long (five times the work).",
    )
