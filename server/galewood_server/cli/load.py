"""The load of `galewood bench-serve`."""

from __future__ import annotations

from galewood.options import METHOD_HELP, Method
from pydantic import BaseModel, Field


class Load(BaseModel):
    """How many clients watch how many trees, for how long, and on which cores."""

    clients: int = Field(default=200, description="Number of clients that read.")
    trees: int = Field(default=1000, description="Trees per forest.")
    forests: int = Field(default=1, description="Number of shared forests; 0 gives each client its own.")
    stalled: int = Field(default=20, description="Additional clients that never read, in a second phase.")
    seconds: float = Field(default=20.0, description="Length of the first phase (s).")
    method: Method = Field(default="modal", description=METHOD_HELP)
    server_core: int = Field(default=0, description="CPU core of the server; −1 for any.")
    client_core: int = Field(default=1, description="CPU core of the clients; −1 for any.")
