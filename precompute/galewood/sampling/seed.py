"""The seed of the training winds."""

SEED = 1
