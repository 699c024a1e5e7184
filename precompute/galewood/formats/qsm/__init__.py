"""Scanned trees as quantitative structure models; in: the bytes of a file; out: wood and leaves as meshes."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
