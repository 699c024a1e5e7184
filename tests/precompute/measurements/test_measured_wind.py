"""Measured winds: files as loggers write them, against the numbers they were made from."""

from __future__ import annotations

import json
import math
from collections.abc import Callable

import numpy as np
import pytest
from galewood.measurements import Measurement, MeasurementError, measured_wind, read_measurement
from galewood.motion.wind import WindField, parse_wind

Line = Callable[[float, float, float], str]
HEAD = "time (s),speed (m/s),direction (deg)\n"
TOA5 = (
    '"TOA5","CR1000","CR1000","7","CR1000.Std.25","CPU:wind.CR1","1","Wind"\n'
    '"TIMESTAMP","RECORD","WS_ms_Avg","WindDir","WindDir_SD1_WVT"\n'
    '"TS","RN","meters/second","Deg","Deg"\n"","","Avg","Smp","WVc"\n'
)


def samples(count: int, interval_s: float) -> list[tuple[float, float, float]]:
    """Time (s), speed (m/s) and direction (°, from) of a gusty wind from the southwest."""
    rng = np.random.default_rng(4)
    times = [k * interval_s for k in range(count)]
    return [
        (
            t,
            max(0.0, 6.0 + 2.0 * math.sin(0.8 * t) + 0.7 * rng.normal()),
            (235.0 + 25.0 * math.sin(0.31 * t)) % 360.0,
        )
        for t in times
    ]


def rows(head: str, line: Line, count: int = 40, interval_s: float = 1.0) -> str:
    """A file: its head, and a line for each sample."""
    return head + "\n".join(line(*sample) for sample in samples(count, interval_s)) + "\n"


def clock(t: float) -> str:
    """Time of day from 12:00 on."""
    return f"{12 + int(t) // 3600:02d}:{int(t) // 60 % 60:02d}:{int(t) % 60:02d}"


def digits(t: float) -> str:
    """The same without colons."""
    return clock(t).replace(":", "")


def plain(t: float, speed: float, angle: float) -> str:
    """Seconds, m/s, degrees."""
    return f"{t:.2f},{speed:.3f},{angle:.1f}"


def decimal_commas(t: float, speed: float, angle: float) -> str:
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


def midnight(t: float, speed: float, angle: float) -> str:
    """Time of day from 23:59:45 on, mph."""
    late = int(t + 3585)
    return (
        f"{(23 + late // 3600) % 24}:{late // 60 % 60:02d}:{late % 60:02d};{speed / 0.44704:.2f};{angle:.0f}"
    )


def two_columns(t: float, speed: float, angle: float) -> str:
    """Date and time in columns of their own, with another speed beside the mean."""
    values = f"{speed:.2f};{1.4 * speed:.2f};{angle:.0f}".replace(".", ",")
    return f"01.05.2024;{clock(t)};{values}"


# name: head, line, number of samples, their interval (s)
FORMATS: dict[str, tuple[str, Line, int, float]] = {
    "seconds": (HEAD, plain, 100, 0.2),
    "no-names": ("", plain, 40, 1.0),
    "decimal-commas": (
        "Zeit [s];Windgeschwindigkeit [km/h];Windrichtung [°]\n", decimal_commas, 100, 0.1,
    ),
    "toa5": (TOA5, toa5, 60, 0.5),
    "iso": (
        "timestamp,wind_speed_kn,wind_dir\n",
        lambda t, s, d: f"2024-02-28T{clock(t)}+02:00,{s / 0.514444:.3f},{d:.0f}", 40, 1.0,
    ),
    "midnight": ("time;ff_mph;dd\n", midnight, 40, 1.0),
    "two-columns": ("Datum;Uhrzeit;Windgeschwindigkeit;Boe max;Windrichtung\n", two_columns, 40, 1.0),
    "month-first": (
        "date,speed mph,dir\n", lambda t, s, d: f"5/13/2024 {clock(t)},{s / 0.44704:.2f},{d:.0f}", 40, 1.0,
    ),
    "towards": (
        "datetime,ws,heading\n",
        lambda t, s, d: f"5/3/2024 1:{clock(t)[3:]} PM,{s:.2f},{(d + 180) % 360:.0f}", 40, 1.0,
    ),
    "whole-seconds": (
        "time,ws,wd\n", lambda t, s, d: f"2024-05-01 {clock(t)},{s:.3f},{d:.1f}", 80, 0.25,
    ),
    "slow": (
        "time (min),speed,direction\n", lambda t, s, d: f"{t / 60:.0f},{s:.2f},{d:.0f}", 40, 600.0,
    ),
    "radians": (
        "s,v wind,speed (ft/s),dir (rad)\n",
        lambda t, s, d: f"{t:.0f},0,{s / 0.3048:.2f},{math.radians(d):.4f}", 40, 1.0,
    ),
    "weather service, 10-minute means": (
        "STATIONS_ID;MESS_DATUM;  QN;FF_10;DD_10;eor\n",
        lambda t, s, d: f"       3987;20240102{digits(t)[:4]};    3; {s:6.2f}; {d:5.0f};eor", 40, 600.0,
    ),
    "compact date and clock": (
        "date,time,ws,wd\n", lambda t, s, d: f"20240102,{clock(t)},{s:.2f},{d:.0f}", 40, 1.0,
    ),
    "compact with seconds": (
        "timestamp,ws,wd\n", lambda t, s, d: f"20240102T{digits(t)}Z,{s:.2f},{d:.0f}", 40, 1.0,
    ),
    "milliseconds": (
        "time,speed,dir\n", lambda t, s, d: f"{1714564800000 + 1000 * t:.0f},{s:.2f},{d:.0f}", 40, 1.0,
    ),
}  # fmt: skip
LONE = "\n".join(f"{100 * k},3,240\n{100 * k + 0.1},3,240" for k in range(20))
# text, error
REFUSED = (
    (
        "",
        "no column names were found. Name a column 'time' and 'speed' with 'direction' (or 'u' and 'v'), "
        "with units, for example: time (s);speed (m/s);direction (deg)",
    ),
    # one cell of thirteen is more than a twentieth of the rows
    (rows(HEAD, plain, 12) + "12.0,fast,240\n", "line 14, column 'speed (m/s)': 'fast' is not a number"),
    (
        rows("time,speed,dir\n", lambda t, s, d: f"2024-05-01 {clock(t)},{s:.2f},{d:.0f}", 12)
        + "later,3,240\n",
        "line 14, column 'time': 'later' is not a time such as 2024-05-31T12:00:00.5 or 12.5",
    ),
    (
        rows(HEAD, plain, 12) + "noon,3,240\n",
        "line 14, column 'time (s)': 'noon' is not a number, as the times above it are",
    ),
    (
        HEAD + "0,-3,240\n",
        "line 2, column 'speed (m/s)': a wind speed cannot be negative; components are columns 'u' and 'v'",
    ),
    (HEAD + "0,3,XY\n", "line 2, column 'direction (deg)': 'XY' is not a number"),
    (rows(HEAD, plain, 9), "only 9 samples have a time and a wind; at least 10 are needed"),
    (HEAD, "there are no rows of numbers below the names of the columns"),
    (
        rows(HEAD, lambda t, s, d: f"{t:.0f},{s + 60:.1f},{d:.0f}"),
        "the mean speed is 66 m/s; check the unit of the speed",
    ),
    (
        rows("time (h),speed (m/s)\n", lambda t, s, d: f"{2 * t:.0f},{s:.2f}"),
        "the samples are more than an hour apart: too far to contain gusts",
    ),
    (
        HEAD + LONE,
        "the longest piece without a gap of more than 60 s has only 2 samples; at least 10 are needed",
    ),
)


def measured(rng: np.random.Generator, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Components to the east and to the north, m/s."""
    return 5.0 + rng.normal(size=count), -4.0 + rng.normal(size=count)


def wind_at(field: WindField, x_m: float, z_m: float, time_s: float) -> np.ndarray:
    out = np.zeros((2, 1))
    field.velocity(np.array([x_m]), np.array([z_m]), time_s, out[0], out[1])
    return out[:, 0]


def test_samples_are_reproduced_at_the_origin_and_later_downwind() -> None:
    seed = 77
    print("seed", seed)
    east, north = measured(np.random.default_rng(seed), 200)
    speed, angle = np.hypot(east, north), np.degrees(np.arctan2(-east, -north)) % 360.0
    lines = [f"{0.25 * k},{speed[k]:.6f},{angle[k]:.6f}" for k in range(200)]
    found = read_measurement("\n".join(["t (s),speed (km/h),direction", *lines]).encode())
    factor = 1 / 3.6
    wind, report = found.wind, found.report
    assert report.mean_speed_m_s == pytest.approx(factor * speed.mean(), rel=1e-6)
    assert report.max_speed_m_s == pytest.approx(factor * speed.max(), rel=1e-6)
    assert report.intensity == pytest.approx(speed.std() / speed.mean(), rel=1e-6)
    assert report.from_deg == pytest.approx(
        math.degrees(math.atan2(-east.mean(), -north.mean())) % 360, abs=1e-4
    )
    field = WindField(parse_wind(json.loads(json.dumps(wind.document()))))
    heading = math.radians(wind.direction_deg)
    for k in (0, 1, 57, 199, 200 + 20 + 57):
        sample = k % (200 + 20)  # the passage back to the beginning takes 5 s
        expected = factor * np.array([east[sample], -north[sample]])
        assert wind_at(field, 0.0, 0.0, 0.25 * k) == pytest.approx(expected, abs=3e-4)
        for along_m, across_m in ((30.0, 0.0), (-12.0, 45.0)):
            x = along_m * math.cos(heading) - across_m * math.sin(heading)
            z = along_m * math.sin(heading) + across_m * math.cos(heading)
            later = wind_at(field, x, z, 0.25 * k + along_m / wind.convection_speed_m_s)
            assert later == pytest.approx(expected, abs=3e-4)


def test_the_loop_has_no_jump() -> None:
    found = read_measurement(rows(HEAD, plain, 100, 0.2).encode())
    field = WindField(found.wind)
    times = np.arange(found.report.loop_s - 8.0, found.report.loop_s + 4.0, 0.01)
    velocity = np.array([wind_at(field, 0.0, 0.0, t) for t in times])
    inside = np.array([wind_at(field, 0.0, 0.0, t) for t in np.arange(2.0, 14.0, 0.01)])
    assert np.abs(np.diff(velocity, axis=0)).max() < 1.5 * np.abs(np.diff(inside, axis=0)).max()


def test_long_and_fast_files_are_cut_and_averaged() -> None:
    lines = "\n".join(f"{k / 20:.2f},{5 + k % 2},270" for k in range(20 * 60 * 20))
    found = read_measurement(f"time (s),speed (m/s),dir\n{lines}".encode(), start_s=60.0)
    assert found.wind.recording.fluctuations().shape == (6000, 2)
    assert found.report.used_s == pytest.approx(595.0)
    assert found.report.used_start_s == pytest.approx(60.0)
    assert found.report.max_speed_m_s == pytest.approx(5.5)  # two samples are averaged
    assert len(json.dumps(found.wind.document())) < 40_000


def found_in(head: str, line: Line, count: int = 40, interval_s: float = 1.0) -> Measurement:
    return read_measurement(rows(head, line, count, interval_s).encode())


@pytest.mark.parametrize("name", FORMATS)
def test_the_wind_is_that_of_the_file(name: str) -> None:
    head, line, count, interval_s = FORMATS[name]
    found = found_in(head, line, count, interval_s)
    _, speed, angle = np.array(samples(count, interval_s)).T
    from_rad = np.radians(angle)
    east, north = -(speed * np.sin(from_rad)).mean(), -(speed * np.cos(from_rad)).mean()
    report = found.report
    assert (report.rows, report.missing, report.gaps, report.duplicates, report.disordered) == (
        count,
        0,
        0,
        0,
        0,
    )
    assert report.rate_hz == pytest.approx(1.0 / interval_s, rel=0.02)
    assert report.mean_speed_m_s == pytest.approx(speed.mean(), rel=1e-3)
    assert report.max_speed_m_s == pytest.approx(speed.max(), rel=1e-3)
    assert report.intensity == pytest.approx(speed.std() / speed.mean(), rel=5e-3)
    assert report.from_deg == pytest.approx(math.degrees(math.atan2(-east, -north)) % 360.0, abs=0.3)
    parse_wind(json.loads(json.dumps(found.wind.document())))
    assert found.wind.recording.interval_s == pytest.approx(interval_s, rel=0.02)


@pytest.mark.parametrize("mark", ["---", "///", "*", "M", "n.a.", "E01"])
def test_a_cell_that_cannot_be_read_counts_as_missing(mark: str) -> None:
    lines = rows("", plain, 90).splitlines()
    lines[40] = f"{lines[40].split(',')[0]},{mark},240"
    report = read_measurement((HEAD + "\n".join(lines)).encode()).report
    assert (report.rows, report.missing, report.gaps) == (90, 1, 1)
    said = "Taken as missing: line 42, column 'speed (m/s)': 'E01' is not a number." in report.notes
    assert said == (mark == "E01")


def test_times_without_a_plausible_unit_are_refused() -> None:
    with pytest.raises(MeasurementError, match="state their unit in the column's name"):
        found_in("time,speed,dir\n", lambda t, s, d: f"{t / 1e6:.7f},{s:.2f},{d:.0f}", 40)


def test_a_moment_of_a_fast_logger_is_refused() -> None:
    with pytest.raises(MeasurementError, match="the samples cover less than 1 s"):
        found_in(HEAD, lambda t, s, d: f"{t:.3f},{s:.2f},{d:.0f}", 15, 0.01)


def test_a_point_of_the_compass_is_a_direction() -> None:
    found = found_in(HEAD, lambda t, s, d: f"{t:.0f},5,{'SW' if t < 20 else 'WSW'}")
    assert found.report.from_deg == pytest.approx(236.25)


def test_components_gaps_and_missing_values() -> None:
    report = found_in("# sonic, 2 m boom\n#t_ms\tu (m/s)\tv (m/s)\n", components, 80, 0.5).report
    assert report.columns == {"time": "t_ms: ms", "u": "u (m/s): m/s", "v": "v (m/s): m/s"}
    assert (report.rows, report.missing, report.gaps) == (73, 1, 2)
    assert report.longest_gap_s == pytest.approx(4.0)
    assert report.from_deg == pytest.approx(235.0, abs=6.0)
    assert report.used_s == pytest.approx(40.0)


def test_disorder_duplicates_and_implausible_values_are_counted() -> None:
    lines = rows("", plain, 60, 0.5).splitlines()
    lines[10], lines[11] = lines[11], lines[10]
    text = "\n".join([*lines[:20], lines[19], "10.01,-9999,240", "10.02,99.9,240", *lines[20:]])
    report = read_measurement((HEAD + text).encode()).report
    counts = (report.rows, report.duplicates, report.disordered, report.implausible, report.missing)
    # the row of 10.00 s comes after those of 10.01 and 10.02 s
    assert counts == (63, 1, 2, 1, 2)
    assert {
        "2 rows without time or wind, ignored.",
        "1 value above 75 m/s, taken as missing.",
        "1 row with the time of another one, ignored.",
        "2 rows out of order, sorted by time.",
    } <= set(report.notes)


def test_a_long_gap_ends_the_part_that_is_used() -> None:
    report = found_in(HEAD, lambda t, s, d: plain(t if t < 30 else t + 300, s, d), 80).report
    assert (report.gaps, report.longest_gap_s) == (1, 301.0)
    assert (report.used_start_s, report.used_s) == (330.0, 50.0)
    assert report.figures["Gaps"] == "1, the longest 5 min 1 s"
    assert "Of 6 min 20 s, 50.0 s are used, from 5 min 30 s after the first sample." in report.notes


def test_fast_series_are_averaged() -> None:
    found = found_in(HEAD, plain, 400, 0.05)
    assert found.report.used_rate_hz == pytest.approx(10.0)
    assert "Averaged from 20.0 Hz to 10.0 Hz." in found.report.notes
    speed = np.array(samples(400, 0.05))[:, 1]
    assert found.report.mean_speed_m_s == pytest.approx(speed.mean(), rel=0.02)


def test_a_wind_without_a_direction_comes_from_the_west() -> None:
    found = found_in("elapsed,speed [cm/s]\n", lambda t, s, d: f"{t:.0f},{100 * s:.1f}")
    assert found.report.from_deg == 270.0
    assert "There is no direction: the wind is assumed to come from the west." in found.report.notes


def test_steady_winds_and_calms_have_no_gusts() -> None:
    steady = found_in(HEAD, lambda t, s, d: f"{t:.0f},5,270")
    calm = found_in(HEAD, lambda t, s, d: f"{t:.0f},0,NaN")
    assert (steady.report.intensity, calm.report.intensity, calm.wind.mean_speed_m_s) == (0.0, 0.0, 0.0)
    assert not calm.wind.recording.fluctuations().any()
    assert calm.wind.convection_speed_m_s == 2.0


def test_the_figures_of_the_report() -> None:
    figures = found_in(
        "time (min),speed,direction\n", lambda t, s, d: f"{t:.0f},{5 + t % 2},270"
    ).report.figures
    assert figures == {
        "Column for time": "time (min): min",
        "Column for speed": "speed: m/s",
        "Column for direction": "direction: ° from",
        "Samples": "40 in 40 min 0 s, one every 1 min 0 s",
        "Mean wind": "5.5 m/s from 270°",
        "Strongest sample": "6.0 m/s",
        "Turbulence intensity": "9 %",
        "Gaps": "none",
    }


@pytest.mark.parametrize(("text", "message"), REFUSED)
def test_faults_are_named(text: str, message: str) -> None:
    with pytest.raises(MeasurementError) as error:
        read_measurement(text.encode())
    assert str(error.value) == message


def test_the_meteorological_direction_is_where_the_wind_comes_from() -> None:
    text = "time,speed,direction\n" + "\n".join(f"{k},6,270" for k in range(20))
    wind = read_measurement(text.encode()).wind
    assert wind.direction_deg == pytest.approx(0.0, abs=1e-9)  # a westerly blows towards x
    text = "time,speed,direction\n" + "\n".join(f"{k},6,0" for k in range(20))
    assert read_measurement(text.encode()).wind.direction_deg == pytest.approx(90.0)  # a northerly, towards z


def test_arrays_give_the_wind_of_a_file_with_the_same_numbers() -> None:
    taken = samples(200, 0.5)
    time_s, speed_m_s, from_deg = (np.array(column) for column in zip(*taken, strict=True))
    exact = HEAD + "\n".join(",".join(repr(number) for number in sample) for sample in taken)
    of_file = read_measurement(exact.encode())
    of_arrays = measured_wind(time_s, speed_m_s, from_deg)
    assert of_arrays.wind == of_file.wind
    dates = np.datetime64("2024-05-31T23:59:00", "ns") + (time_s * 1e9).astype("timedelta64[ns]")
    assert measured_wind(dates, speed_m_s, from_deg).wind == of_file.wind
    assert measured_wind(time_s, speed_m_s).report.from_deg == pytest.approx(270.0)
    gap = np.where(np.arange(200) % 50 == 7, np.nan, speed_m_s)
    assert measured_wind(time_s, gap, from_deg).report.missing == 4


@pytest.mark.parametrize(
    ("time_s", "speed_m_s", "said"),
    [
        (range(20), [5.0] * 19, "speed_m_s: expected 20 numbers"),
        (range(20), [-1.0] * 20, "cannot be negative"),
        (range(20), ["calm"] * 20, "speed_m_s: expected an array of numbers"),
        (range(4), [5.0] * 4, "only 4 samples"),
        (np.arange(20) * 1e-6, [5.0] * 20, "more than any anemometer"),
    ],
)
def test_arrays_that_are_no_series_are_refused(time_s: object, speed_m_s: object, said: str) -> None:
    with pytest.raises(MeasurementError, match=said):
        measured_wind(time_s, speed_m_s)  # type: ignore[arg-type]


@pytest.mark.parametrize("bad", ["202401020860", "20240102086", "---", ""])
def test_one_bad_moment_does_not_make_the_others_numbers(bad: str) -> None:
    lines = [f"20240102{k // 6:02d}{10 * (k % 6):02d};{3 + k % 4}.0;270" for k in range(144)]
    lines[50] = f"{bad};4.0;270"
    found = read_measurement(("MESS_DATUM;FF_10 (m/s);DD_10\n" + "\n".join(lines) + "\n").encode())
    assert found.report.rate_hz == pytest.approx(1 / 600)
