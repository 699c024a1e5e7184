"""Comparisons: with the full simulation, exact solutions, measured trees, the paper and other programs."""
