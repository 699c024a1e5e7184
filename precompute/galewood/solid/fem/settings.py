"""Settings of a finite-element model and its simulation; cheap to import."""

import math
from dataclasses import dataclass, field, replace
from typing import Literal

Scheme = Literal["backward-euler", "tr-bdf2"]
Element = Literal["fitted", "linear", "quadratic"]

LARGEST_PHASE_RAD = 0.18
"""Largest phase of the first natural mode that a step may cover."""


@dataclass(frozen=True, kw_only=True)
class FemSettings:
    """Simulation settings; ValueError if a value is out of range.

    dt_s is the table's time step, which is divided into `substeps` equal steps of `scheme`; 0 leaves their
    number to the model (`resolved`). `j_max` and `tolerance` (relative to the first residual) belong to the
    paper's Algorithm 2; with TR-BDF2 and `j_max` > 1 both of its stages are iterated. The damping ratio of
    the wood applies at the first natural frequency and at `damping_frequency_ratio` times it (Rayleigh's two
    targets).
    """

    dt_s: float = 1 / 30
    substeps: int = 0
    scheme: Scheme = "tr-bdf2"
    element: Element = "fitted"
    j_max: int = 1
    tolerance: float = 1e-6
    damping_frequency_ratio: float = 3.0
    gravity: bool = True
    root_stiffness_nm_rad: float | None = field(default=None, repr=False)
    """Rotational stiffness of the root plate, N·m/rad; None: rigid. The model's key covers its springs."""

    def __post_init__(self) -> None:
        if not 1e-4 <= self.dt_s <= 1:
            raise ValueError("dt_s must lie between 0.0001 and 1 s")
        if not 0 <= self.substeps <= 64 or not 1 <= self.j_max <= 50:
            raise ValueError("substeps must lie in 0..64 and j_max in 1..50")
        if self.scheme not in ("backward-euler", "tr-bdf2"):
            raise ValueError(f"unknown scheme {self.scheme!r}: backward-euler or tr-bdf2")
        if self.element not in ("fitted", "linear", "quadratic"):
            raise ValueError(f"unknown element {self.element!r}: fitted, linear or quadratic")
        if not 1 < self.damping_frequency_ratio <= 100:
            raise ValueError("damping_frequency_ratio must lie above 1 and at most at 100")
        if self.root_stiffness_nm_rad is not None and not 1 <= self.root_stiffness_nm_rad <= 1e15:
            raise ValueError("root_stiffness_nm_rad must lie between 1 and 1e15 N·m/rad, or be None (rigid)")

    def resolved(self, first_hz: float) -> "FemSettings":
        """These settings with a number of substeps for a tree of this first natural frequency, Hz.

        TR-BDF2 lowers a frequency by about 0.04 (ω h)². Steps of at most LARGEST_PHASE_RAD keep that of the
        first mode below 0.2 % (docs/physics.md). Backward Euler takes one step, as in the paper.
        """
        if self.substeps:
            return self
        phase_rad = 2 * math.pi * first_hz * self.dt_s
        fine = math.ceil(phase_rad / LARGEST_PHASE_RAD) if self.scheme == "tr-bdf2" else 1
        return replace(self, substeps=min(max(fine, 1), 64))
