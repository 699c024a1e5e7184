"""Individuals of a species: their motion from their own beams and the fitted table of the species.

The service reads documents, and has no use for what makes tables.
"""

import lazy_loader

# its return type is not annotated
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(  # pyright: ignore[reportUnknownVariableType]
    __name__, __file__
)
