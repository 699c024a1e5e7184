"""Threads of the numerical libraries: one each, because work is spread over processes.

The results of a build must not depend on the number of threads either. BLAS and OpenMP read the variables
when they are loaded, so they must be set before numpy is imported.
"""

from __future__ import annotations

SINGLE_THREADED = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
