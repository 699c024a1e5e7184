"""A tree as rigid bodies on elastic hinges, fitted to the finite elements: what robot simulators read."""
