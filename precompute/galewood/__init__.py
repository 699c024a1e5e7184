"""From a tree mesh to a lookup table of its motion in wind."""
