"""Pictures of a tree from all sides, from which engines draw it far away."""
