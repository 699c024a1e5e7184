"""USD stages of a moving tree."""
