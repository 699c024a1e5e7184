"""A tree for MuJoCo: rigid bodies on elastic hinges, fitted to the finite elements."""
