"""Skinning of a tree; in: its drawn mesh, its wood as tetrahedra or beams, modes; out: nodes and joints.

The *axis*, a tree of points along the branches, moves and turns with the model, as the bones of a skeleton
would. In the bind pose, the tree at rest, each vertex gets a *binding*: a link of the axis, and a skinning
weight for either end. Wood is bound beside itself on the axis (nearest place), with a limited slope of the
arc length over the surface, so that a fork does not tear; each piece of twigs or foliage is rigid and
shares the binding of what it touches; a crown or frond around a branch is bound along the branch's chord.
Once the motion is known, the weights are *smoothed* in the farthest poses: bindings of vertices of
stretched edges are moved towards their neighbours' one by one (relaxation) and all at once (L-BFGS on the
excess stretch). The axis is simplified (Douglas and Peucker) to *nodes*, between which its motion is
interpolated linearly; bindings, rounded to 32 places a link, become *joints*: two nodes, the weight of the
second, and a rest position. A vertex moves with its joint and turns about it. Pieces attached to the middle
of a long, straight edge get a node that blends the joints of its ends. When a pose is drawn, the stretch of
links between nodes is limited. For masses, wind and pulls, vertices are embedded in the tetrahedra by
barycentric weights.

The pose is cheap to import; all other names are loaded when they are first used.
"""

from typing import TYPE_CHECKING

from galewood.solid.skinning.node_poses import (
    Pose,
    drawn_positions,
    joint_pose,
    joint_rows,
    node_pose,
    sine_and_cosine,
    vertex_rows,
)
from galewood.util import lazily

if TYPE_CHECKING:
    from galewood.solid.skinning.attached_pieces import with_attached_pieces
    from galewood.solid.skinning.attachment import edge_samples
    from galewood.solid.skinning.axis import Axis, axis_of_frame, axis_of_tets
    from galewood.solid.skinning.bindings import Bindings
    from galewood.solid.skinning.distortion import Distortion, distortion_line
    from galewood.solid.skinning.embedding import (
        LARGEST_RIGID_PIECE,
        leading_vertices,
        nearest_tets,
        points_embedding,
        render_embedding,
    )
    from galewood.solid.skinning.skin import MotionSamples, Skin, make_skin
    from galewood.solid.skinning.smoothed_weights import smoothed_bindings
    from galewood.solid.skinning.surface_bindings import vertex_bindings

__getattr__ = lazily(
    __name__,
    {
        "with_attached_pieces": "galewood.solid.skinning.attached_pieces",
        "edge_samples": "galewood.solid.skinning.attachment",
        "Axis": "galewood.solid.skinning.axis",
        "Bindings": "galewood.solid.skinning.bindings",
        "axis_of_frame": "galewood.solid.skinning.axis",
        "axis_of_tets": "galewood.solid.skinning.axis",
        "Distortion": "galewood.solid.skinning.distortion",
        "distortion_line": "galewood.solid.skinning.distortion",
        "LARGEST_RIGID_PIECE": "galewood.solid.skinning.embedding",
        "leading_vertices": "galewood.solid.skinning.embedding",
        "nearest_tets": "galewood.solid.skinning.embedding",
        "points_embedding": "galewood.solid.skinning.embedding",
        "render_embedding": "galewood.solid.skinning.embedding",
        "MotionSamples": "galewood.solid.skinning.skin",
        "Skin": "galewood.solid.skinning.skin",
        "make_skin": "galewood.solid.skinning.skin",
        "smoothed_bindings": "galewood.solid.skinning.smoothed_weights",
        "vertex_bindings": "galewood.solid.skinning.surface_bindings",
    },
)
__all__ = [
    "LARGEST_RIGID_PIECE",
    "Axis",
    "Bindings",
    "Distortion",
    "MotionSamples",
    "Pose",
    "Skin",
    "axis_of_frame",
    "axis_of_tets",
    "distortion_line",
    "drawn_positions",
    "edge_samples",
    "joint_pose",
    "joint_rows",
    "leading_vertices",
    "make_skin",
    "nearest_tets",
    "node_pose",
    "points_embedding",
    "render_embedding",
    "sine_and_cosine",
    "smoothed_bindings",
    "vertex_bindings",
    "vertex_rows",
    "with_attached_pieces",
]
