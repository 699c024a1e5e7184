"""Mesh import; in: the parts of a file; out: a TreeMesh (metres, wood and foliage separated) and a render
GLB.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
