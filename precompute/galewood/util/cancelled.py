"""Cancellation of long-running work."""


class Cancelled(Exception):
    """Raised by a progress callback to cancel a build."""
