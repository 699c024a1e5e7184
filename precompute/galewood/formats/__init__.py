"""Readers of files; in: the bytes of a mesh or of a scanned tree; out: its parts, as the file draws them."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
