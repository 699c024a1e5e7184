"""A tree as a frame of round beams along its branches; in: branches with radii, wood; out: natural modes."""

from galewood.solid.beams.frame import Frame, FrameModes, frame_frequencies, frame_matrices, frame_modes
from galewood.solid.beams.joined import joined_frame

__all__ = [
    "Frame",
    "FrameModes",
    "frame_frequencies",
    "frame_matrices",
    "frame_modes",
    "joined_frame",
]
