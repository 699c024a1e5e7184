"""Write the golden measurements: ``python -m tests.golden.make_measured``.

Files as loggers write them, with the wind and the report that Python reads from each, or the error.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from galewood.wind import MeasurementError, read_measurement

from tests.golden.texts import refused, write_golden

HERE = Path(__file__).parent
Line = Callable[[float, float, float], str]


def series(count: int, interval_s: float, line: Line, seed: int = 4) -> str:
    """Lines of a gusty wind from the southwest: ``line`` of time (s), speed (m/s) and direction (°)."""
    rng = np.random.default_rng(seed)
    lines: list[str] = []
    for k in range(count):
        t = k * interval_s
        speed = max(0.0, 6.0 + 2.0 * math.sin(0.8 * t) + 0.7 * rng.normal())
        lines.append(line(t, speed, (235.0 + 25.0 * math.sin(0.31 * t)) % 360.0))
    return "\n".join(lines) + "\n"


def clock(t: float) -> str:
    """Time of day from 12:00 on."""
    return f"{12 + int(t) // 3600:02d}:{int(t) // 60 % 60:02d}:{int(t) % 60:02d}"


def plain(t: float, speed: float, angle: float) -> str:
    """Seconds, m/s, degrees."""
    return f"{t:.2f},{speed:.3f},{angle:.1f}"


def comma(t: float, speed: float, angle: float) -> str:
    """With semicolons, decimal commas, km/h."""
    return f"{t:.1f};{3.6 * speed:.2f};{angle:.1f}".replace(".", ",")


def components(t: float, speed: float, angle: float) -> str:
    """Milliseconds and components, with a gap of 4 s and a missing value."""
    toward = math.radians(angle + 180.0)
    if 20.0 < t < 24.0:
        return ""
    u = "NaN" if t == 10.0 else f"{speed * math.sin(toward):.3f}"
    return f"{1000 * t:.0f}\t{u}\t{speed * math.cos(toward):.3f}"


def toa5(t: float, speed: float, angle: float) -> str:
    """A row of a Campbell logger."""
    tenths = f".{round(10 * (t % 1))}" if t % 1 else ""
    return f'"2024-05-01 {clock(t)}{tenths}",{int(t)},{speed:.3f},{angle:.1f},3.1'


TOA5 = (
    '"TOA5","CR1000","CR1000","7","CR1000.Std.25","CPU:wind.CR1","1","Wind"\n'
    '"TIMESTAMP","RECORD","WS_ms_Avg","WindDir","WindDir_SD1_WVT"\n'
    '"TS","RN","meters/second","Deg","Deg"\n"","","Avg","Smp","WVc"\n'
)
HEAD = "time (s),speed (m/s),direction (deg)\n"


def shuffled() -> str:
    """Out of order, with duplicates and faults."""
    lines = series(60, 0.5, plain).splitlines()
    lines[10], lines[11] = lines[11], lines[10]
    return HEAD + "\n".join([*lines[:20], lines[19], "10.01,-9999,240", "10.02,99.9,240", *lines[20:]])


def rows(head: str, line: Line, count: int = 40, interval_s: float = 1.0) -> str:
    """A short file."""
    return head + series(count, interval_s, line)


FILES: dict[str, str] = {
    "seconds": rows(HEAD, plain, 100, 0.2),
    "decimal-commas": rows("Zeit [s];Windgeschwindigkeit [km/h];Windrichtung [°]\n", comma, 100, 0.1),
    "components": rows("# sonic, 2 m boom\n#t_ms\tu (m/s)\tv (m/s)\n", components, 80, 0.5),
    "toa5": rows(TOA5, toa5, 60, 0.5),
    "iso": rows(
        "timestamp,wind_speed_kn,wind_dir\n",
        lambda t, s, d: f"2024-02-28T{clock(t)}+02:00,{s / 0.514444:.3f},{d:.0f}",
    ),
    "midnight": rows(
        "time;ff_mph;dd\n",
        lambda t, s, d: (
            f"{(23 + int(t + 3585) // 3600) % 24}:{int(t + 3585) // 60 % 60:02d}:{int(t + 3585) % 60:02d};"
            f"{s / 0.44704:.2f};{d:.0f}"
        ),
    ),
    "two-columns": rows(
        "Datum;Uhrzeit;Windgeschwindigkeit;Boe max;Windrichtung\n",
        lambda t, s, d: f"01.05.2024;{clock(t)};{s:.2f};{1.4 * s:.2f};{d:.0f}".replace(".", ",", 3).replace(
            "01,05,2024", "01.05.2024"
        ),
    ),
    "month-first": rows("date,speed mph,dir\n", lambda t, s, d: f"5/13/2024 {clock(t)},{s:.2f},{d:.0f}"),
    "afternoon": rows(
        "datetime,ws,heading\n", lambda t, s, d: f"5/3/2024 1:{clock(t)[3:]} PM,{s:.2f},{(d + 180) % 360:.0f}"
    ),
    "whole-seconds": rows("time,ws,wd\n", lambda t, s, d: f"2024-05-01 {clock(t)},{s:.3f},{d:.1f}", 80, 0.25),
    "fast": rows(HEAD, plain, 400, 0.05),
    "slow": rows("time (min),speed,direction\n", lambda t, s, d: f"{t / 60:.0f},{s:.2f},{d:.0f}", 40, 600.0),
    "compass": rows(HEAD, lambda t, s, d: f"{t:.0f},{s:.2f},{'SW' if d < 240 else 'WSW'}"),
    "radians": rows(
        "s,v wind,speed (ft/s),dir (rad)\n",
        lambda t, s, d: f"{t:.0f},0,{s / 0.3048:.2f},{math.radians(d):.4f}",
    ),
    "no-direction": rows("elapsed,speed [cm/s]\n", lambda t, s, d: f"{t:.0f},{100 * s:.1f}"),
    "no-names": rows("", plain),
    "faults": shuffled(),
    "long-gap": rows(HEAD, lambda t, s, d: plain(t if t < 30 else t + 300, s, d), 80),
    "calm": rows(HEAD, lambda t, s, d: f"{t:.0f},0,NaN"),
    "steady": rows(HEAD, lambda t, s, d: f"{t:.0f},5,270"),
    "epoch": rows("time,speed,dir\n", lambda t, s, d: f"{1714564800000 + 1000 * t:.0f},{s:.2f},{d:.0f}"),
}
STARTS = {"seconds": 4.0}
BAD: dict[str, str] = {
    "empty": "",
    "no-columns": "a,b\n1,2\n",
    "scan": "parent,x0,y0,z0,x1,y1,z1,radius\n0,0,0,0,0,1,0,0.1\n",
    "word": rows(HEAD, plain, 12) + "12.0,fast,240\n",
    "time-word": rows("time,speed,dir\n", lambda t, s, d: f"2024-05-01 {clock(t)},{s:.2f},{d:.0f}", 12)
    + "later,3,240\n",
    "time-number": rows(HEAD, plain, 12) + "noon,3,240\n",
    "negative": HEAD + "0,-3,240\n",
    "compass": HEAD + "0,3,XY\n",
    "few": rows(HEAD, plain, 9),
    "none": HEAD,
    "unit": rows(HEAD, lambda t, s, d: f"{t:.0f},{s + 60:.1f},{d:.0f}"),
    "hours": rows("time (h),speed (m/s)\n", lambda t, s, d: f"{2 * t:.0f},{s:.2f}"),
    "torn": HEAD + "\n".join(f"{100 * k},3,240\n{100 * k + 0.1},3,240" for k in range(20)),
}


def read(name: str, text: str) -> dict[str, Any]:
    """What Python reads from a file."""
    start_s = STARTS.get(name, 0.0)
    found = read_measurement(text.encode(), start_s=start_s)
    return {
        "name": name,
        "text": text,
        "start_s": start_s,
        "report": found.report.document(),
        "wind": found.wind.document(),
    }


def main() -> None:
    """Write the file."""
    golden = {
        "files": [read(name, text) for name, text in FILES.items()],
        "refused": [refused(name, text, read_measurement, MeasurementError) for name, text in BAD.items()],
    }
    write_golden(HERE / "measured.json", golden)


if __name__ == "__main__":
    main()
