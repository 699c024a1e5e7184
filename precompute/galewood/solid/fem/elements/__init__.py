"""Forces and stiffness of corotational tetrahedra: numba kernels and what they are compiled from."""
