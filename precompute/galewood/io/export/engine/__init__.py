"""What engines expect of a mesh beside its motion: tangents and levels of detail."""
