"""Commands for what wind does to trees: strain, critical wind, stands."""
