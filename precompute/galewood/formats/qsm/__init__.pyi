from .branches import Line as Line
from .reading import ScannedTree as ScannedTree
from .reading import read_qsm as read_qsm
from .tables import has_cylinder_columns as has_cylinder_columns
from .treeqsm import HDF5_HEADER as HDF5_HEADER
from .tubes import tube as tube
