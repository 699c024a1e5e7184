"""The rigid bodies of a tree as a model for MuJoCo."""
