"""The service's commands: serve, upload, doctor, key, bench-serve."""

__all__ = []
