"""Loads what the first streamed forest needs, so that its clients need not wait for that."""

from __future__ import annotations

import numpy as np
from galewood.motion.wind import Wind, parse_wind_or_state

from galewood_server.stream.wire import Forest, Group


def warm_up(table: bytes) -> None:
    """Import the simulation and load its compiled kernels by stepping one tree of a table. Takes seconds."""
    from galewood.table import decode

    from galewood_server.stream.forest import ForestClock, ForestStepper

    wind = Wind().document()
    trees = np.array([[0.0, 0.0, 0.0, 1.0]], np.float32)
    plan = Forest("stream", (Group("0" * 64, 1),), wind, 0.0, None, trees)
    clock = ForestClock(parse_wind_or_state(wind), 0.0)
    stepper = ForestStepper([decode(table)], plan, clock, [None])
    clock.tick()
    stepper.step(())
