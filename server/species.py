"""The built-in species."""

from __future__ import annotations

from server.context import Service


async def register(service: Service) -> None:
    return
