"""How people and programs reach the library: command line, Python API, notebooks and exported files."""
