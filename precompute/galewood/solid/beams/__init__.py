"""A tree as a frame of round beams along its branches; in: branches with radii, wood; out: natural modes, and
the pose of the beams under any load."""

from galewood.solid.beams.bending import (
    BentRods,
    NoEquilibrium,
    RodBuckling,
    RodModes,
    Rods,
    bent,
    rod_buckling,
    rod_modes,
)
from galewood.solid.beams.frame import (
    JOINT_STIFFNESS_FACTOR,
    Frame,
    FrameModes,
    frame_frequencies,
    frame_matrices,
    frame_modes,
)
from galewood.solid.beams.joined import joined_frame

__all__ = [
    "JOINT_STIFFNESS_FACTOR",
    "BentRods",
    "Frame",
    "FrameModes",
    "NoEquilibrium",
    "RodBuckling",
    "RodModes",
    "Rods",
    "bent",
    "frame_frequencies",
    "frame_matrices",
    "frame_modes",
    "joined_frame",
    "rod_buckling",
    "rod_modes",
]
