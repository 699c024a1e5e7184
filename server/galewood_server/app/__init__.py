"""The application: assembly, startup and shutdown of the service."""

from galewood_server.app.main import create_app, run

__all__ = ["create_app", "run"]
