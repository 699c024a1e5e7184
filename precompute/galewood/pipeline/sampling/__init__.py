"""Training runs; in: a FemModel and winds; out: snapshots of motion and state, one file per run."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
