"""`--to live`: a GLB that sways by itself, in the wind that the program gives it."""
