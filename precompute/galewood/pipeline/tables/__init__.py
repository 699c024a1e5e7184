"""What a build makes, and from which options: tables, compliance file, metadata, report, expected motion."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
