"""Threads of the numerical libraries: one each, because work is spread over processes.

The results of a build must not depend on the number of threads either. BLAS and OpenMP read the variables
when they are loaded, so they must be set before numpy is imported; where numpy was there first, as in a
program that imports this package, `single_threaded` limits what is loaded.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")

SINGLE_THREADED = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}


def single_threaded(work: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """A function during which the numerical libraries of this process have one thread each.

    Many products of small matrices with more threads take twice the processor time, and longer.
    """

    @wraps(work)
    def limited(*args: Arguments.args, **kwargs: Arguments.kwargs) -> Result:
        from threadpoolctl import threadpool_limits  # needed here only

        with threadpool_limits(limits=1):
            return work(*args, **kwargs)

    return limited
