"""The modal reduced-order model: its tensors, polynomial terms and step."""

from galewood.modal.drag import DRAG_INPUTS, add_drag, drag_tensors
from galewood.modal.step import MAX_STEPS_PER_ADVANCE, advance_trees, widened, working_room
from galewood.modal.tensors import ModalTensors, coupled_of, force_terms, shape_terms
from galewood.modal.terms import write_force_terms, write_pose_terms

__all__ = [
    "DRAG_INPUTS",
    "MAX_STEPS_PER_ADVANCE",
    "ModalTensors",
    "add_drag",
    "advance_trees",
    "coupled_of",
    "drag_tensors",
    "force_terms",
    "shape_terms",
    "widened",
    "working_room",
    "write_force_terms",
    "write_pose_terms",
]
