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
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
