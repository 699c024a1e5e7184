"""What happened, by minute: rates, latencies, outcomes, memory, descriptors."""

from __future__ import annotations

import time
from collections import Counter
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
import psutil

FEWEST_HZ = 29.0


class HasProcesses(Protocol):
    """The servers under load; which they are changes when one is started again."""

    @property
    def processes(self) -> list[psutil.Process]: ...


@dataclass
class FrameTimes:
    """When one watcher got its frames, also over several sockets."""

    gaps_ms: Counter[int] = field(default_factory=Counter[int])
    """How often two frames came so many milliseconds after each other."""
    last_s: float | None = None

    def frame(self) -> None:
        """A frame has come."""
        now_s = time.monotonic()
        if self.last_s is not None:
            self.gaps_ms[round(1e3 * (now_s - self.last_s))] += 1
        self.last_s = now_s

    def end(self) -> None:
        """The run ends: a frame that has not come yet comes now at the earliest."""
        if self.last_s is not None:
            self.frame()


def gap_percentiles(times: list[FrameTimes], percent: list[float]) -> list[float]:
    """Percentiles, in ms, of the times between two frames of all watchers."""
    total = sum((one.gaps_ms for one in times), Counter[int]())
    if not total:
        return [np.nan] * len(percent)
    lengths = np.array(sorted(total))
    shares = np.cumsum([total[length] for length in lengths]) / total.total()
    return [float(lengths[np.searchsorted(shares, p / 100 - 1e-12)]) for p in percent]


def frame_count(times: list[FrameTimes], longer_than_s: float = 0.0) -> int:
    """How many frames came more than so many seconds after the one before."""
    return sum(n for one in times for gap_ms, n in one.gaps_ms.items() if gap_ms > 1e3 * longer_than_s)


@dataclass
class Report:
    """Counts of all actors. An outcome is expected or not; only unexpected ones are errors."""

    servers: HasProcesses
    longest_wait_s: float | None = None
    """How long a watcher may wait for its next frame; None if that does not matter."""
    outcomes: Counter[str] = field(default_factory=Counter[str])
    unexpected: Counter[str] = field(default_factory=Counter[str])
    rates_hz: list[float] = field(default_factory=list[float])
    """Frames per second of each watcher since the last line."""
    health_ms: list[float] = field(default_factory=list[float])
    waits_s: list[float] = field(default_factory=list[float])
    """How long watchers were without a stream after they had lost it."""
    frame_times: list[FrameTimes] = field(default_factory=list[FrameTimes])
    """Of each watcher."""
    all_health_ms: list[float] = field(default_factory=list[float])
    slowest_hz: list[float] = field(default_factory=list[float])
    mean_hz: list[float] = field(default_factory=list[float])
    began_s: float = field(default_factory=time.monotonic)

    def note(self, actor: str, outcome: object, expected: bool = True) -> None:
        """Count an outcome of an actor."""
        name = f"{actor}: {outcome}"
        self.outcomes[name] += 1
        if not expected:
            self.unexpected[name] += 1

    def line(self) -> str:
        """The figures since the last line."""
        rates, health = self.rates_hz or [np.nan], self.health_ms or [np.nan]
        if self.rates_hz:
            self.slowest_hz.append(min(rates))
            self.mean_hz.append(float(np.mean(rates)))
        self.all_health_ms += self.health_ms
        memory, files, cpu_s = self._processes()
        text = (
            f"{time.monotonic() - self.began_s:6.0f} s  frames/s mean {np.mean(rates):5.1f} slowest "
            f"{min(rates):5.1f} ({len(self.rates_hz)})  health ms p50 {np.percentile(health, 50):6.1f} "
            f"p99 {np.percentile(health, 99):7.1f}  "
            f"longest wait ms {gap_percentiles(self.frame_times, [100])[0]:.0f}  memory MB {memory:6.0f}  "
            f"descriptors {files:4d}  "
            f"CPU s {cpu_s:6.0f}  errors {sum(self.unexpected.values())}  {psutil.getloadavg()[0]:.1f} load"
        )
        self.rates_hz, self.health_ms = [], []
        return text

    def _processes(self) -> tuple[float, int, float]:
        memory, files, cpu_s = 0.0, 0, 0.0
        for server in self.servers.processes:
            try:
                times = server.cpu_times()
                memory += server.memory_info().rss / 1e6
                files += server.num_fds()
                cpu_s += times.user + times.system
            except psutil.NoSuchProcess:
                continue
        return memory, files, cpu_s

    def summary(self) -> str:
        """All outcomes, and the figures of the whole run."""
        lines = [f"{count:8d}  {name}" for name, count in sorted(self.outcomes.items())]
        health = self.all_health_ms or [np.nan]
        lines.append(
            f"slowest watcher of any interval {min(self.slowest_hz, default=0.0):.1f} frames/s, mean "
            f"{np.mean(self.mean_hz or [0.0]):.1f}; health ms p50 {np.percentile(health, 50):.1f} "
            f"p99 {np.percentile(health, 99):.1f} worst {max(health):.1f}"
        )
        typical, late, worst = gap_percentiles(self.frame_times, [50, 99, 100])
        lines.append(f"ms between two frames of a watcher p50 {typical:.0f} p99 {late:.0f} worst {worst:.0f}")
        lines.append(
            f"frames {frame_count(self.frame_times)}, of which after more than "
            + ", ".join(f"{s:.1f} s {frame_count(self.frame_times, s)}" for s in (0.5, 1.0, 1.5, 2.0, 3.0))
        )
        if self.waits_s:
            lines.append(f"longest wait of a watcher without stream {max(self.waits_s):.1f} s")
        lines.append(f"unexpected: {dict(self.unexpected) or 'nothing'}")
        return "\n".join(lines)

    @property
    def passed(self) -> bool:
        """Whether nothing unexpected happened and the watchers got their frames, on average or in time."""
        if self.longest_wait_s is not None:
            (worst_ms,) = gap_percentiles(self.frame_times, [100])
            return not self.unexpected and worst_ms <= 1e3 * self.longest_wait_s
        return not self.unexpected and float(np.mean(self.mean_hz or [0.0])) >= FEWEST_HZ
