"""Wood that a file does not draw and without which its pieces would hang in the air."""
