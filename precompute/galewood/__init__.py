"""Galewood: how trees move in wind, from a mesh to a table to a forest.

    import galewood

    tree = galewood.read("oak.glb", height_m=12)
    table = galewood.build(tree)
    forest = galewood.Forest([table], galewood.grid(100), galewood.Wind(mean_speed_m_s=10))
    forest.step(1 / 30)
    forest.vertices_m(tree=0)

The names in ``__init__.pyi`` are the public API; the sub-packages may change between versions.
"""

from importlib.metadata import version as _version

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
__version__ = _version("galewood")
