"""Exports the motion of a tree for other programs: engines, modellers, renderers."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
