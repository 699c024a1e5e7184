"""The modal reduced-order model: its tensors, polynomial terms and step."""

from galewood.motion.modal.drag import add_drag, drag_inputs, drag_tensors
from galewood.motion.modal.each import LANE_COUNT, advance_each, sizes_of, tensors_of_each
from galewood.motion.modal.gradient import add_drag_gradient, add_terms_gradient
from galewood.motion.modal.step import advance_trees, float64_tensors, working_room
from galewood.motion.modal.tensors import ModalTensors, coupled_of, force_terms, mean_gust, shape_terms
from galewood.motion.modal.terms import write_force_terms, write_pose_terms

__all__ = [
    "LANE_COUNT",
    "ModalTensors",
    "add_drag",
    "add_drag_gradient",
    "add_terms_gradient",
    "advance_each",
    "advance_trees",
    "coupled_of",
    "drag_inputs",
    "drag_tensors",
    "float64_tensors",
    "force_terms",
    "mean_gust",
    "shape_terms",
    "sizes_of",
    "tensors_of_each",
    "working_room",
    "write_force_terms",
    "write_pose_terms",
]
