"""Parameters and tolerances of a table; cheap to import."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class TableSettings:
    """Parameters and tolerances of a table (docs/design/0002-pose-easing.md explains the defaults)."""

    modes: int | None = None
    """Oscillators of the modal model; None: as few of the standard sizes as follow the training runs."""
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
    truncation_share: float = 8.6e-4
    """Largest vertex error of the reduced basis over the height."""
    node_share: float = 5e-4
    """Largest deviation of a branch from the interpolation between nodes in strong wind, over the height."""
    node_sway_share: float = 0.003
    """The same over the largest motion of the tree, so that stiff trees also bend smoothly."""
