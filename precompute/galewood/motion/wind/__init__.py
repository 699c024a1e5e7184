"""The wind field; in: wind document, positions, time; out: velocity or pressure vectors.

Documents are cheap to import; what evaluates the wind loads numba.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
