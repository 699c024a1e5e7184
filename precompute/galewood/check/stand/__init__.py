"""What the wind does to the stems of a stand; in: an inventory, strain of built-in trees; out: a report."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
