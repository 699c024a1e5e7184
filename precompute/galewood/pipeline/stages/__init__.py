"""The stages of a build: from a mesh file to a table file, with progress and what is published on the way."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
