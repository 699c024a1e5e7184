"""Options of a build, and the parameters of its table that nobody needs to choose."""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import Field

from galewood.options import BuildRequest
from galewood.solid.fem import FemSettings


@dataclass(frozen=True)
class TableSettings:
    """Parameters and tolerances of a table (docs/design/0002-pose-easing.md explains the defaults)."""

    modes: int | None = None
    """Oscillators of the modal model; None: the standard size."""
    sigma_share: float = 0.3
    """σ of Eq. 16 over the RMS pressure of the records."""
    weight_leverage: float = 0.94
    """w / (1 − w) at the largest weight, over the median E_int; relative, as stiff trees differ less."""
    weight_initial: float | None = None
    """Initial weight; None: 5 % below the largest weight."""
    weight_maximum: float | None = None
    """Largest weight; None: derived from ``weight_leverage``."""
    weight_growth: float = 0.01
    pose_easing: float = 0.08
    node_share: float = 5e-4
    """Largest deviation of a branch from the interpolation between nodes in strong wind, over the height."""
    node_sway_share: float = 0.003
    """The same over the largest motion of the tree, so that stiff trees also bend smoothly."""


class BuildOptions(BuildRequest):
    """All inputs of a build besides the mesh: a request, and what the service does not offer.

    With ``reference`` the table is built from the reference model itself.
    """

    reference: bool = Field(
        default=False, description="Use the quadratic reference elements: about ten times as slow."
    )
    reference_frames: int = Field(
        default=60,
        ge=0,
        description="Frames of the run that is compared with the reference elements; 0: no comparison.",
    )

    @property
    def fem(self) -> FemSettings:
        """Settings of the finite elements."""
        element = "quadratic" if self.reference else "fitted"
        return FemSettings(element=element, root_stiffness_nm_rad=self.root_stiffness_nm_rad)

    @property
    def table(self) -> TableSettings:
        """Parameters of the table."""
        return TableSettings(modes=self.modes)


EXPECTED_MOTION = "galewood.pipeline.tables.expected:with_expected_motion"
"""What a sandboxed mesh import can add to its report: how the tree will move."""
