"""Trees that sway below a cell of a notebook. The widget needs the extra ``notebook``."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
