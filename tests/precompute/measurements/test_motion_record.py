"""Records of motion as loggers write them."""

from __future__ import annotations

import numpy as np
import pytest
from galewood.check.sway import analyse_motion
from galewood.measurements import MeasurementError, MotionRecord, motion_record, read_motion
from galewood.util import Floats

COUNT = 400
RATE_HZ = 10.0


def sway(k: int, axis: int = 0) -> float:
    return round(float(np.sin(0.3 * k + axis)), 5)


def table(head: str, row: str, count: int = COUNT) -> bytes:
    """A file of a head and rows with {t} (s), {x} and {y}."""
    rows = [
        row.format(t=k / RATE_HZ, x=sway(k), y=sway(k, 1), ms=1000 * k / RATE_HZ, k=k) for k in range(count)
    ]
    return "\n".join([head, *rows]).encode()


FILES = {
    "strain": (table("time (s),strain_x (µε),strain_y (µε)", "{t},{x},{y}"), "strain", "1", 1e-6, 2),
    "microstrain": (table("Time;Microstrain N;Microstrain E", "{t};{x};{y}"), "strain", "1", 1e-6, 2),
    "tilt": (table("t_s\ttilt_x_deg\ttilt_y_deg", "{t}\t{x}\t{y}"), "tilt", "deg", 1.0, 2),
    "German tilt": (table("Zeit;Neigung x (°);Neigung y (°)", "{t};{x};{y}"), "tilt", "deg", 1.0, 2),
    "inclinometer": (table("Time (ms),Inclinometer 1 (mrad)", "{ms},{x}"), "tilt", "deg", 0.0573, 1),
    "acceleration": (table("time,ax (g),ay (g),az (g)", "{t},{x},{y},1"), "acceleration", "m/s²", 9.80665, 2),
    "AccX": (
        table("Time [s],Acc_X [m/s2],Acc_Y [m/s2],Acc_Z [m/s2]", "{t},{x},{y},9.8"),
        "acceleration", "m/s²", 1.0, 2,
    ),
    "sway": (table("time,sway (cm)", "{t},{x}"), "sway", "m", 0.01, 1),
    "bare axes": (table("time,x,y", "{t},{x},{y}"), "signal", "", 1.0, 2),
    "volts": (table("Time,NS_mV,EW_mV", "{t},{x},{y}"), "signal", "", 1.0, 2),
    "gauges": (table("TIMESTAMP,SG1_mV,SG2_mV", "{t},{x},{y}"), "strain", "", 1.0, 2),
    "any two": (table("time,T25_a,T25_b", "{t},{x},{y}"), "signal", "", 1.0, 2),
    "units below": (table("time,strain_x,strain_y\ns,µε,µε", "{t},{x},{y}"), "strain", "1", 1e-6, 2),
    "comments": (table("# tree 7\n# logger\ntime,strain_x", "{t},{x}"), "strain", "", 1.0, 1),
    "dates": (
        table("timestamp,strain_n,strain_e", "2024-01-02T10:00:{t:06.3f},{x},{y}", 500), "strain", "", 1.0, 2,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", FILES)
def test_files_of_loggers(name: str) -> None:
    data, quantity, unit, scale, axes = FILES[name]
    found = read_motion(data)
    assert (found.quantity, found.unit, found.values.shape[1]) == (quantity, unit, axes)
    assert found.rate_hz == pytest.approx(RATE_HZ, rel=1e-6)
    expected = np.array([[sway(k, axis) for axis in range(axes)] for k in range(len(found.values))])
    np.testing.assert_allclose(found.values, scale * expected, rtol=1e-3, atol=1e-3 * scale)


def test_whole_seconds_are_spread() -> None:
    rows = [f"2024-01-02 10:00:{k // 10:02d},{sway(k)}" for k in range(500)]
    found = read_motion("\n".join(["time,tilt", *rows]).encode())
    assert found.rate_hz == pytest.approx(RATE_HZ, rel=0.01)


def test_wind_may_be_slower_and_in_other_units() -> None:
    rows = [f"{k / RATE_HZ},{sway(k)},{36 + k / 10 if k % 10 == 0 else ''}" for k in range(COUNT)]
    found = read_motion("\n".join(["time,strain,wind speed (km/h)", *rows]).encode())
    assert found.wind_m_s is not None
    np.testing.assert_allclose(found.wind_m_s[:300], 10 + np.arange(300) / 36, rtol=1e-3)


def test_columns_can_be_chosen() -> None:
    data = table("clock,foo,bar", "{t},{x},{y}")
    with pytest.raises(MeasurementError, match="--columns"):
        read_motion(data)
    found = read_motion(data, columns={"time": "clock", "axis1": "bar"})
    assert found.values.shape == (COUNT, 1) and found.values[0, 0] == pytest.approx(sway(0, 1))
    with pytest.raises(MeasurementError, match=r"'baz'.*'clock'"):
        read_motion(data, columns={"axis1": "baz"})


def test_the_speed_of_the_wind_is_read_and_not_its_direction() -> None:
    row = ["time,wind_dir,wind_speed,strain_n,strain_e", "s,deg,km/h,microstrain,microstrain"]
    rows = [f"{k / RATE_HZ},185,36,{sway(k)},{sway(k, 1)}" for k in range(COUNT)]
    found = read_motion("\n".join([*row, *rows]).encode())
    assert found.wind_m_s is not None and found.unit == "1"
    np.testing.assert_allclose(found.wind_m_s, 10.0)
    fault = [row.replace(",36,", ",9999,") for row in rows]
    assert read_motion("\n".join([*row, *fault]).encode()).wind_m_s is None


def test_other_trees_of_a_file_are_named() -> None:
    data = table("time,T1_strain_N,T1_strain_E,T2_strain_N,T2_strain_E", "{t},{x},{y},{y},{x}")
    assert "Not used: T2_strain_N, T2_strain_E" in read_motion(data).notes[0]
    second = read_motion(data, columns={"axis1": "T2_strain_N", "axis2": "T2_strain_E"})
    assert second.values[0, 0] == pytest.approx(sway(0, 1))


def test_headers_of_campbell_loggers() -> None:
    head = [
        '"TOA5","CR1","CR1000","1234","CR1000.Std.01","CPU:strain.CR1","1","Table"',
        '"TIMESTAMP","RECORD","Strain_N(1)"', '"TS","RN","microstrain"', '"","","Smp"',
    ]  # fmt: skip
    rows = [f'"2024-01-02 10:00:{k / RATE_HZ:06.3f}",{k},{sway(k)}' for k in range(500)]
    found = read_motion("\n".join([*head, *rows]).encode())
    assert (found.quantity, found.rate_hz) == ("strain", pytest.approx(RATE_HZ))


@pytest.mark.parametrize("name", ["Datum/Uhrzeit", "Date/Time", "DOY"])
def test_names_of_times(name: str) -> None:
    rows = [
        f"{k / RATE_HZ / 86400 if name == 'DOY' else f'02.01.2024 10:00:{k / RATE_HZ:06.3f}'},{sway(k)}"
        for k in range(500)
    ]
    assert read_motion("\n".join([f"{name},tilt", *rows]).encode()).rate_hz == pytest.approx(
        RATE_HZ, rel=1e-3
    )


def test_wrong_arguments_are_refused() -> None:
    data = table("time,strain_x,strain_y", "{t},{x},{y}")
    with pytest.raises(MeasurementError, match="has times"):
        read_motion(data, rate_hz=4.0)
    with pytest.raises(MeasurementError, match="not as 'foo'"):
        read_motion(data, columns={"foo": "strain_x"})
    with pytest.raises(MeasurementError, match="the same column"):
        read_motion(data, columns={"axis1": "strain_x", "axis2": "strain_x"})
    with pytest.raises(MeasurementError, match="above 0"):
        read_motion(table("strain_x", "{x}"), rate_hz=-4.0)
    with pytest.raises(MeasurementError, match="wind_m_s: expected 300 numbers"):
        motion_record(np.arange(300) / 10, np.zeros(300), wind_m_s=np.ones(20))
    dates = np.datetime64("2024-01-01T00:00", "ms") + np.arange(300) * np.timedelta64(100, "ms")
    assert motion_record(dates, np.sin(np.arange(300))).rate_hz == pytest.approx(10.0)


def hung(turn: Floats, unit: str = "g", names: str = "xyz", size: float = 1.0, axes: int = 3) -> bytes:
    """An accelerometer whose axes are the rows of ``turn``, in world axes of which the third is up.

    It sways by 0.02 g at 0.4 Hz along the first and by 0.005 g along the second one.
    """
    time_s = np.arange(6000) / RATE_HZ
    phase = 2 * np.pi * 0.4 * time_s + np.cumsum(np.random.default_rng(7).normal(0, 0.05, 6000))
    world = np.column_stack([0.02 * np.sin(phase), 0.005 * np.cos(phase), np.ones(6000)])
    rows = [
        ",".join([f"{t:.1f}", *(f"{size * one:.6f}" for one in row)])
        for t, row in zip(time_s, (world @ turn.T)[:, :axes], strict=True)
    ]
    stated = f" ({unit})" if unit else ""
    return "\n".join(
        [",".join(["time (s)", *(f"acc_{name}{stated}" for name in names[:axes])]), *rows]
    ).encode()


UP_X, UP_Y, UP_Z = (np.roll(np.eye(3), shift, axis=0) for shift in (1, 2, 0))
LEANS = np.array([[0.8, 0, 0.6], [0, 1, 0], [-0.6, 0, 0.8]])


@pytest.mark.parametrize(("turn", "vertical"), [(UP_X, "acc_x"), (UP_Y, "acc_y"), (UP_Z, "acc_z")])
def test_the_axis_of_gravity_is_vertical_whatever_its_name(turn: Floats, vertical: str) -> None:
    for upside in (1.0, -1.0):
        found = read_motion(hung(upside * turn))
        assert found.unit == "m/s²" and found.values.shape == (6000, 2)
        assert found.columns is not None and found.columns["vertical"].startswith(vertical)
        deviations = np.sort(found.values.std(axis=0)) * np.sqrt(2) / 9.80665
        np.testing.assert_allclose(deviations, [0.005, 0.02], rtol=0.02)
        along = analyse_motion(found).along
        assert along.resonance is not None
        assert along.resonance.frequency_hz == pytest.approx(0.4, rel=0.02)
        assert any(f"Gravity is along '{vertical}" in note for note in found.notes) == (turn is not UP_Z)


def test_a_leaning_sensor_is_turned_until_gravity_is_vertical() -> None:
    found = read_motion(hung(LEANS))
    assert "leans by 37°" in " ".join(found.notes)
    assert np.abs(found.values.mean(axis=0)).max() < 1e-3
    spread = np.linalg.eigvalsh(np.cov(found.values.T)) ** 0.5 * np.sqrt(2) / 9.80665
    np.testing.assert_allclose(spread, [0.005, 0.02], rtol=0.02)


def test_the_unit_of_an_acceleration_follows_from_gravity() -> None:
    for size, unit in ((9.80665, "m/s²"), (1.0, "g"), (1000.0, "mg")):
        found = read_motion(hung(UP_X, unit="", size=size))
        assert found.unit == "m/s²" and f"taken as {unit}," in " ".join(found.notes)
        assert found.values.std() == pytest.approx(read_motion(hung(UP_X)).values.std(), rel=1e-3)


def test_accelerations_that_gravity_says_nothing_of_are_read_by_name() -> None:
    without = read_motion(hung(UP_Z, size=0.3))
    assert without.values.shape[1] == 2 and "vertical" not in (without.columns or {})
    one = read_motion(hung(UP_X, axes=2))
    assert one.values.shape[1] == 1 and "motion is that of acc_y" in " ".join(one.notes)
    chosen = read_motion(hung(UP_X), columns={"axis1": "acc_x (g)", "axis2": "acc_z (g)"})
    assert chosen.values[:, 0].mean() == pytest.approx(9.80665, rel=1e-3)
    numbered = read_motion(hung(UP_X, names="123"))
    assert (numbered.columns or {})["vertical"] == "acc_1 (g)"


def test_a_file_without_times_needs_its_rate() -> None:
    data = table("strain_x,strain_y", "{x},{y}")
    with pytest.raises(MeasurementError, match="--rate-hz"):
        read_motion(data)
    assert read_motion(data, rate_hz=20.0).rate_hz == pytest.approx(20.0)


def record(times: list[float], values: list[float]) -> MotionRecord:
    return motion_record(times, values)


def test_short_gaps_are_bridged_and_the_longest_piece_is_used() -> None:
    times = [k / RATE_HZ for k in range(1000) if k not in (100, 101) and not 300 <= k < 330]
    found = record(times, [np.sin(t) for t in times])
    assert found.gap_count == 1
    assert len(found.values) == 670
    np.testing.assert_allclose(found.values[:, 0], np.sin(33 + np.arange(670) / RATE_HZ), atol=2e-2)


def test_disorder_repetition_and_missing_values() -> None:
    times = [k / RATE_HZ for k in range(600)]
    values = [float(np.sin(t)) for t in times]
    values[50] = float("nan")
    mixed = [*times[1:20], times[0], *times[20:], times[-1]]
    found = record(mixed, [*values[1:20], values[0], *values[20:], values[-1]])
    assert found.missing_count == 2
    np.testing.assert_allclose(found.values[:, 0], np.sin(np.arange(600) / RATE_HZ), atol=2e-2)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (table("time,strain", "{t},{x}", 100), "only 100 samples"),
        (table("time (ms),strain", "{k}e-3,{x}"), "samples a second"),
        (table("time (h),strain", "{t},{x}"), "samples a second"),
        (table("time,strain", "{t},oops"), r"line \d, column 'strain'"),
        (table("time,strain", "oops,{x}"), "line 2, column 'time'"),
        (b"time,strain\n", "no rows"),
        (b"", "no columns"),
        (b"\x00\xff" * 500, "no columns"),
        (b"name;size\nash;3\n", "no columns"),
    ],
)
def test_what_is_wrong_is_said(data: bytes, message: str) -> None:
    with pytest.raises(MeasurementError, match=message):
        read_motion(data)


def test_arrays_of_other_shapes_are_refused() -> None:
    with pytest.raises(MeasurementError, match="for each of the 300 times"):
        motion_record(np.arange(300) / 10, np.zeros((300, 3)))


@pytest.mark.parametrize(
    ("head", "factor", "says"),
    [
        ("time (s),x_mm", 0.05, "'x_mm' has a standard deviation of 0.0353 mm"),
        ("time (s),sway (m)", 50.0, "in cm or mm it would be"),
        ("time (s),strain_x (%)", 50.0, "in µε it would be"),
        ("time (s),tilt_x (mrad)", 1e-3, "in rad it would be"),
        ("time (s),acc_x (mg)", 0.1, "in m/s² or g it would be"),
    ],
)
def test_a_unit_that_its_numbers_contradict_is_said(head: str, factor: float, says: str) -> None:
    rows = [f"{k / RATE_HZ},{factor * sway(k):.9g}" for k in range(COUNT)]
    found = read_motion("\n".join([head, *rows]).encode())
    (note,) = [note for note in found.notes if "Is the unit right?" in note]
    assert says in note
    plausible = read_motion(FILES["sway"][0])
    assert not any("Is the unit" in note for note in plausible.notes)


def test_gravity_in_another_than_the_stated_unit_is_said() -> None:
    rows = [f"{k / RATE_HZ},{0.1 * sway(k)},{0.1 * sway(k, 1)},1.01" for k in range(COUNT)]
    found = read_motion("\n".join(["time,ax (m/s2),ay (m/s2),az (m/s2)", *rows]).encode())
    (note,) = [note for note in found.notes if "gravity" in note]
    assert "in g it would be" in note
    right = read_motion("\n".join(["time,ax (g),ay (g),az (g)", *rows]).encode())
    assert not any("Is the unit" in note for note in right.notes)
