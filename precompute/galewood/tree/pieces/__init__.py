"""Which pieces of a file are wood and which are leaves, and which belong to another tree."""
