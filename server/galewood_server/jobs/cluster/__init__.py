"""Simulation on an embedded or external Dask cluster."""
