"""Simulating on a Dask cluster, embedded or external."""
