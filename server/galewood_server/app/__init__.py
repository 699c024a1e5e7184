"""The application: how the service is assembled, starts and stops."""

from galewood_server.app.main import create_app, run

__all__ = ["create_app", "run"]
