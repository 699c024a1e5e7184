"""Measured winds: from the file of a logger to a wind document of the model recorded."""
