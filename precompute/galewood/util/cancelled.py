"""How a caller stops long work."""


class Cancelled(Exception):
    """Raised by a progress callback to stop a build."""
