"""The rigid bodies of a tree as a robot description, URDF."""
