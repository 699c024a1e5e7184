"""From a mesh file to a table: training runs, model order reduction, and the stages in order."""
