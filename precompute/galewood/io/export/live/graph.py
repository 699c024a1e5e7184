"""The behaviour graph that steps a live tree on every tick and writes the weights of its morph targets."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import reduce
from typing import Any

import numpy as np

from galewood.constants import (
    HALF_AIR_DENSITY_KG_M3,
    MAX_STEPS_PER_ADVANCE,
    PRESSURE_COMPRESSION,
    STREAMLINING_SPEED_M_S,
)
from galewood.io.export.live.behaviour import Behaviour, Constant, Input, Value, numbers, whole
from galewood.io.export.live.gusts import LiveGusts
from galewood.io.export.live.model import LiveModel
from galewood.util import Floats

OSCILLATOR_LANES = 4
"""Oscillators that a vector of the graph holds."""
WIND_EVENT = "galewood_wind"


def behaviour_of(model: LiveModel, gusts: LiveGusts, nodes: Sequence[int], name: str) -> dict[str, Any]:
    """The graph as JSON; ``nodes``: the glTF nodes whose weights are the coordinates of the model."""
    graph = Behaviour(name)
    wind, gustiness = (
        graph.variable("wind_m_s", *gusts.wind_m_s),
        graph.variable("gustiness", gusts.gustiness),
    )
    clock, phase = graph.variable("clock_s", 0.0), graph.variable("phase", 0.0)
    _listen(graph, gusts, wind, gustiness)
    tick = graph.node("event/onTick")
    ticked = _Sequence(graph, tick, "out")
    ticked.add(_advance_clock(graph, Value(tick, "timeSinceLastTick"), model.dt_s, clock, phase))
    air = _air(graph, gusts, graph.get(wind), graph.get(gustiness), graph.get(clock))
    pressure = _pressure(graph, model, air)
    groups = [_Group(graph, k) for k in range(-(-len(model.drag) // OSCILLATOR_LANES))]
    steps = {"startIndex": whole(0), "endIndex": _steps(graph, graph.get(phase))}
    loop = ticked.add(graph.node("flow/for", steps))
    _step(graph, model, groups, pressure, _Sequence(graph, loop, "loopBody"))
    stepped = _Sequence(graph, loop, "completed")
    stepped.add(_show(graph, groups, graph.get(phase)))
    for node in nodes:
        for k in range(len(model.drag)):
            weight = groups[k // OSCILLATOR_LANES].parts[k % OSCILLATOR_LANES]
            stepped.add(graph.point(f"/nodes/{node}/weights/{k}", weight))
    return graph.document()


class _Sequence:
    """Nodes that are activated one after another.

    The ``out`` of nodes that set something exists in the release candidate of the specification, but
    Babylon.js 9.35 ignores it; this works with and without it.
    """

    def __init__(self, graph: Behaviour, node: int, flow: str) -> None:
        """Continue the ``flow`` of a node with it."""
        self._graph, self._added = graph, 0
        self._node = graph.then(node, graph.node("flow/sequence"), flow)

    def add(self, node: int) -> int:
        """Add a node, which is returned. Flows are activated in the order of their texts."""
        self._added += 1
        return self._graph.then(self._node, node, f"{self._added:04d}")


class _Group:
    """The variables of up to four oscillators: coordinates and speeds, now and a step before, and what is
    shown."""

    def __init__(self, graph: Behaviour, index: int) -> None:
        zero = (0.0,) * OSCILLATOR_LANES
        self.e, self.v = graph.variable(f"e_{index}", *zero), graph.variable(f"v_{index}", *zero)
        self.e_before = graph.variable(f"e_before_{index}", *zero)
        self.v_before = graph.variable(f"v_before_{index}", *zero)
        self.shown = graph.variable(f"shown_{index}", *zero)
        shown = graph.get(self.shown)
        self.parts = [_component(graph, shown, lane, OSCILLATOR_LANES) for lane in range(OSCILLATOR_LANES)]
        """The shown coordinate of each."""


def _listen(graph: Behaviour, gusts: LiveGusts, wind: int, gustiness: int) -> None:
    """Let programs set the wind by an event too."""
    x, z = gusts.wind_m_s
    event = graph.event(WIND_EVENT, {"x_m_s": x, "z_m_s": z, "gustiness": 0.0})
    heard = graph.node("event/receive", event=event)
    both = graph.value("math/combine2", Value(heard, "x_m_s"), Value(heard, "z_m_s"))
    graph.then(heard, graph.set({wind: both, gustiness: Value(heard, "gustiness")}), "out")


def _advance_clock(graph: Behaviour, passed_s: Value, dt_s: float, clock: int, phase: int) -> int:
    """Add the time since the last tick, which is not a number at first."""
    first = graph.value("math/isNaN", passed_s)
    inputs: dict[str, Input] = {"condition": first, "a": numbers(0.0), "b": passed_s}
    passed = Value(graph.node("math/select", inputs))
    rest = graph.value("math/fract", graph.get(phase))
    return graph.set({
        clock: graph.value("math/add", graph.get(clock), passed),
        phase: graph.value("math/add", rest, graph.value("math/div", passed, numbers(dt_s))),
    })  # fmt: skip


def _steps(graph: Behaviour, phase: Value) -> Value:
    most = graph.value("math/min", phase, numbers(MAX_STEPS_PER_ADVANCE))
    return graph.value("type/floatToInt", most)


def _air(graph: Behaviour, gusts: LiveGusts, mean: Value, gustiness: Value, time_s: Value) -> Value:
    """The wind (x, z) at a time: the mean with gusts (``LiveGusts.at``)."""
    ripple = _sum(graph, [_wave(graph, wave, time_s) for wave in gusts.waves])
    stronger = graph.value("math/add", numbers(1.0), graph.value("math/mul", gustiness, ripple))
    factor = graph.value("math/max", numbers(0.0), stronger)
    angle = graph.value("math/mul", gustiness, _wave(graph, gusts.swing, time_s))
    stronger = graph.value("math/mul", mean, graph.value("math/combine2", factor, factor))
    return Value(graph.node("math/rotate2D", {"a": stronger, "angle": angle}))


def _wave(graph: Behaviour, wave: tuple[float, float, float], time_s: Value) -> Value:
    hz, share, turns = wave
    angle = graph.value("math/mul", time_s, numbers(math.tau * hz))
    angle = graph.value("math/add", angle, numbers(math.tau * turns))
    return graph.value("math/mul", numbers(share), graph.value("math/cos", angle))


def _pressure(graph: Behaviour, model: LiveModel, air: Value) -> tuple[Value, Value, Value]:
    """Pressure along x and z, and pressure over speed, each four times (``LiveModel.pressure``)."""
    speed = graph.value("math/length", air)
    slow = graph.value("math/min", speed, numbers(STREAMLINING_SPEED_M_S))
    over = graph.value(
        "math/max", graph.value("math/div", speed, numbers(STREAMLINING_SPEED_M_S)), numbers(1.0)
    )
    power = graph.value("math/pow", over, numbers(model.exponent - 1.0))
    per_speed = graph.value("math/mul", graph.value("math/mul", slow, numbers(HALF_AIR_DENSITY_KG_M3)), power)
    strength = graph.value("math/div", graph.value("math/mul", per_speed, speed), numbers(model.most_pa))
    ratio = graph.value("math/max", strength, numbers(1.0))
    excess = graph.value("math/sub", ratio, numbers(1.0))
    excess = graph.value(
        "math/add", numbers(1.0), graph.value("math/div", excess, numbers(PRESSURE_COMPRESSION))
    )
    grown = graph.value("math/mul", numbers(PRESSURE_COMPRESSION), graph.value("math/log", excess))
    scale = graph.value("math/div", graph.value("math/add", numbers(1.0), grown), ratio)
    factor = graph.value("math/mul", scale, per_speed)
    x, z = (graph.value("math/mul", factor, _component(graph, air, axis, 2)) for axis in range(2))
    return _four(graph, x), _four(graph, z), _four(graph, per_speed)


def _step(
    graph: Behaviour,
    model: LiveModel,
    groups: list[_Group],
    pressure: tuple[Value, Value, Value],
    flow: _Sequence,
) -> None:
    """One step of all oscillators (``LiveModel``), four at a time.

    From copies of the state: Babylon.js 9.35 sets the variables of a node one after another, and evaluates
    each when those before have changed already.
    """
    state = {group.e_before: graph.get(group.e) for group in groups}
    flow.add(graph.set({**state, **{group.v_before: graph.get(group.v) for group in groups}}))
    x, z, per_speed = pressure
    values: dict[int, Input] = {}
    for k, group in enumerate(groups):
        r00, r01, r10, r11, s0, s1 = (_lanes(column, k) for column in model.step.T)
        e, v = graph.get(group.e_before), graph.get(group.v_before)
        along = graph.value("math/mul", _lanes(model.load[:, 0], k), x)
        force = graph.value("math/add", along, graph.value("math/mul", _lanes(model.load[:, 1], k), z))
        free = _sum(graph, [graph.value("math/mul", r00, e), graph.value("math/mul", r01, v)])
        moved = graph.value("math/add", free, graph.value("math/mul", s0, force))
        damping = graph.value("math/mul", _lanes(model.drag / model.dt_s, k), per_speed)
        force = graph.value("math/sub", force, graph.value("math/mul", damping, moved))
        values[group.e] = _sum(graph, [e, free, graph.value("math/mul", s0, force)])
        turned = _sum(graph, [graph.value("math/mul", r10, e), graph.value("math/mul", r11, v)])
        values[group.v] = _sum(graph, [v, turned, graph.value("math/mul", s1, force)])
    flow.add(graph.set(values))


def _show(graph: Behaviour, groups: list[_Group], phase: Value) -> int:
    """Interpolate between the last two steps."""
    share = _four(graph, graph.value("math/fract", phase))
    return graph.set({
        group.shown: graph.value("math/mix", graph.get(group.e_before), graph.get(group.e), share)
        for group in groups
    })  # fmt: skip


def _lanes(column: Floats, group: int) -> Constant:
    """The numbers of a group's oscillators; 0 where there is none."""
    part = column[OSCILLATOR_LANES * group : OSCILLATOR_LANES * (group + 1)]
    return numbers(*np.pad(part, (0, OSCILLATOR_LANES - len(part))).tolist())


def _four(graph: Behaviour, value: Value) -> Value:
    return graph.value("math/combine4", value, value, value, value)


def _component(graph: Behaviour, vector: Value, index: int, size: int) -> Value:
    """A component of a vector, by a product: Babylon.js 9.35 refuses the vectors of math/extract2 and
    extract4."""
    return graph.value("math/dot", vector, numbers(*np.eye(size)[index].tolist()))


def _sum(graph: Behaviour, values: Sequence[Value]) -> Value:
    return reduce(lambda first, second: graph.value("math/add", first, second), values)
