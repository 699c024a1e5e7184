"""The four models of the wind and what they share; ``precompute.wind`` is the front door."""
