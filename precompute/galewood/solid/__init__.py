"""From a tree to a model: tetrahedra, skeleton, beams, finite elements, skinning."""
