"""Skeletons, skinning weights and animated bones of a moving tree."""
