"""The job queue: jobs run in child processes and store their results. Only this package uses Dask.

Job processes import it too, and have no use for what the supervisor loads.
"""

import lazy_loader

# its return type is not annotated
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(  # pyright: ignore[reportUnknownVariableType]
    __name__, __file__
)
